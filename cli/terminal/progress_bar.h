// SPDX-License-Identifier: MIT
// The bar on standard error while a command works: drawn by a thread of its own, so that it moves
// while the work says nothing.
#pragma once

#include <string>

namespace batten::internal {

// Whether a bar may be drawn: standard error is a terminal that can go back in a line.
bool BarPossible();

// Tells the bar how far the work is. It is drawn from a second after the first note on, ten times a
// second at most, while the program is in the foreground; where no bar is possible a line is
// written every ten seconds.
void NoteProgress(const char* stage, double fraction);

// Tells it what a whole stage amounts to, so that it shows a rate (progress_meter.h).
void SetProgressAmount(const std::string& stage, double total, const std::string& unit);

// Wipes the bar; the next note brings it back. Returns at the latest a tenth of a second after a
// terminal stopped taking text.
void HideBar();

}  // namespace batten::internal
