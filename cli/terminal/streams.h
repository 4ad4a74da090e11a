// SPDX-License-Identifier: MIT
// Text on the standard streams: past buffers, in colours.
#pragma once

#include <string>

namespace batten::internal {

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

}  // namespace batten::internal
