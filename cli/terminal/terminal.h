// SPDX-License-Identifier: MIT
// The terminal's side of a command: progress, warnings, Ctrl-C.
#pragma once

#include <string>
#include <vector>

#include "batten/fitting/progress.h"

namespace batten::internal {

// From here on Ctrl-C and SIGTERM ask work to stop; if it has not within a moment, temporary files
// are removed and the process ends.
void WatchForInterrupt();

// That moment is longer from here on, though less than a second: others have to stop first.
void BePatient();

// A progress callback that draws a bar on standard error once work has taken a second, if that is a
// terminal and `quiet` is not set (else it writes a line every ten seconds), and that stops work
// after Ctrl-C or when the limit of time is past (interrupt.h).
Progress MakeProgress(bool quiet);

// That files are being read from now on: the bar says how fast. Nothing where it is not drawn.
void BeginReading(const std::vector<std::string>& paths, bool quiet);

// That a stage goes over so many points, or other things: the bar says how fast. Nothing where it
// is not drawn.
void TellAmount(const char* stage, double total, const char* unit, bool quiet);

// Wipes the bar, if there is one.
void ClearProgress();

void PrintNote(const std::string& text);
void PrintWarning(const std::string& text);
void PrintError(const std::string& text);

}  // namespace batten::internal
