// SPDX-License-Identifier: MIT
// Numbers in messages.
#pragma once

#include <charconv>
#include <cmath>
#include <string>

namespace batten::internal {

// The shortest text that reads back as the same number.
inline std::string NumberText(double number) {
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, number).ptr);
}

// Six digits of it, for messages about measured things.
inline std::string RoundedText(double number) {
  char text[32];
  return std::string(
      text, std::to_chars(text, text + sizeof text, number, std::chars_format::general, 6).ptr);
}

// "[0, 1]"
inline std::string IntervalText(double lower, double upper) {
  return "[" + NumberText(lower) + ", " + NumberText(upper) + "]";
}

// A share of one in whole per cent: "37 %".
inline std::string Percent(double share) { return std::to_string(std::lround(100 * share)) + " %"; }

}  // namespace batten::internal
