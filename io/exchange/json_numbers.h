// SPDX-License-Identifier: MIT
// Numbers and lists of them as JSON text. Not installed.
#pragma once

#include <charconv>
#include <cmath>
#include <string>
#include <utility>

namespace batten::internal {

// The shortest text that reads back bit by bit.
inline void Append(std::string& text, double number) {
  char digits[40];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
  if (number == 0 && std::signbit(number)) text += ".0";  // "-0" would be read as the integer 0
}

template <typename Numbers>
void AppendList(std::string& text, const Numbers& numbers) {
  text += '[';
  bool first = true;
  for (const double number : numbers) {
    if (!std::exchange(first, false)) text += ", ";
    Append(text, number);
  }
  text += ']';
}

}  // namespace batten::internal
