// SPDX-License-Identifier: MIT
// The terminal's side of a long command: progress, warnings, Ctrl-C.
#pragma once

#include <string>

#include "batten/fitting/progress.h"

namespace batten {

// From here on Ctrl-C and SIGTERM ask work to stop; if it has not within a moment, temporary files
// are removed and the process ends.
void WatchForInterrupt();
bool Interrupted();

// A progress callback that draws a bar on standard error once work has taken a second, if that is a
// terminal and `quiet` is not set, and that stops work after Ctrl-C.
Progress MakeProgress(bool quiet);

// Wipes the bar, if there is one.
void ClearProgress();

void PrintWarning(const std::string& text);
void PrintError(const std::string& text);

}  // namespace batten
