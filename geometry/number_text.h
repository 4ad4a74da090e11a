// SPDX-License-Identifier: MIT
// Numbers in messages.
#pragma once

#include <charconv>
#include <string>

namespace batten {

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

}  // namespace batten
