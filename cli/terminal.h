// SPDX-License-Identifier: MIT
// The terminal's side of a command: progress, warnings, colours, Ctrl-C.
#pragma once

#include <string>
#include <vector>

#include "batten/fitting/progress.h"

namespace batten {

// From here on Ctrl-C and SIGTERM ask work to stop; if it has not within a moment, temporary files
// are removed and the process ends.
void WatchForInterrupt();
bool Interrupted();

// A progress callback that draws a bar on standard error once work has taken a second, if that is a
// terminal and `quiet` is not set, and that stops work after Ctrl-C.
Progress MakeProgress(bool quiet);

// That files are being read from now on: the bar says how fast. Nothing where it is not drawn.
void BeginReading(const std::vector<std::string>& paths, bool quiet);

// That a stage goes over so many points, or other things: the bar says how fast. Nothing where it
// is not drawn.
void TellAmount(const char* stage, double total, const char* unit, bool quiet);

// Wipes the bar, if there is one.
void ClearProgress();

void PrintWarning(const std::string& text);
void PrintError(const std::string& text);

// Writes to standard error, past any buffer. What can't be written is lost.
void WriteToErrors(const std::string& text);

enum class Stream { kOutput, kErrors };
enum class Tone { kError, kWarning, kGood, kShort };

// The text in the tone's colour (bold red, yellow, green, yellow) where the stream is a terminal
// and neither NO_COLOR (any text but none, no-color.org) nor TERM=dumb says otherwise; else as it
// is.
std::string Toned(const std::string& text, Tone tone, Stream stream);

// A result line whose last part, after the last "; ", is the verdict on a tolerance.
std::string WithVerdict(const std::string& line, bool reached);

}  // namespace batten
