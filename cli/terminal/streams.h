// SPDX-License-Identifier: MIT
// Text on the standard streams: past buffers, in colours.
#pragma once

#include <string>

namespace batten::internal {

// Writes to standard error, past any buffer. What can't be written is lost.
void WriteToErrors(const std::string& text);

// The text as a terminal may show it: control characters, marks that turn the direction of writing,
// and bytes that are not UTF-8 become escapes (\n, \x1b).
std::string Printable(const std::string& text);

// Writes a line of results to standard output, printable.
void PrintResult(const std::string& line);

enum class Stream { kOutput, kErrors };
enum class Tone { kError, kWarning, kGood, kShort };

// The text in the tone's colour (bold red, yellow, green, yellow) where the stream is a terminal
// and neither NO_COLOR (any text but none, no-color.org) nor TERM=dumb says otherwise; else as it
// is.
std::string Toned(const std::string& text, Tone tone, Stream stream);

// The same for a line whose last part, after the last "; ", is the verdict on a tolerance: in its
// colour.
void PrintVerdict(const std::string& line, bool reached);

}  // namespace batten::internal
