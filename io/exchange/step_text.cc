// SPDX-License-Identifier: MIT
#include "io/exchange/step_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string_view>

#include "io/exchange/geometry_names.h"

namespace batten::internal {
namespace {

// A real number as STEP wants it, with a decimal point, in the shortest form that reads back
// exactly.
std::string ShortestReal(double value) {
  char digits[40];
  std::string text(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  const size_t exponent = text.find('e');
  if (exponent != std::string::npos) text[exponent] = 'E';
  if (text.find('.') == std::string::npos) text.insert(std::min(exponent, text.size()), 1, '.');
  return text;
}

}  // namespace

std::string WithShortestReals(const std::string& text) {
  std::string result;
  result.reserve(text.size());
  bool quoted = false;
  for (size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (quoted && c == '\'') {
      // OpenCASCADE's parser takes a doubled quote for the end unless a letter or digit follows.
      const size_t second = std::min(text.find_first_not_of('\n', i + 1), text.size());
      const size_t after = std::min(text.find_first_not_of('\n', second + 1), text.size());
      if (second < text.size() && text[second] == '\'') {
        const bool plain =
            after < text.size() && std::isalnum(static_cast<unsigned char>(text[after]));
        result += plain ? "\'\'" : "\\X2\\0027\\X0\\";
        i = second + 1;
        continue;
      }
    }
    if (c == '\'') quoted = !quoted;
    if (quoted && c != '\'') {
      const size_t end = std::min(text.find('\'', i), text.size());
      std::string inside = text.substr(i, end - i);
      inside.erase(std::remove(inside.begin(), inside.end(), '\n'), inside.end());
      result += ToStepText(inside);
      i = end;
      continue;
    }
    const bool starts = !quoted && (c == '-' || (c >= '0' && c <= '9'));
    const size_t end =
        starts ? std::min(text.find_first_not_of("0123456789.E+-", i), text.size()) : i + 1;
    const std::string_view token = std::string_view(text).substr(i, end - i);
    double value = 0;
    const bool real = starts && token.find('E') != token.npos &&
                      std::from_chars(token.data(), token.data() + token.size(), value).ptr ==
                          token.data() + token.size();
    result += real ? ShortestReal(value) : std::string(token);
    i = end;
  }
  return result;
}

}  // namespace batten::internal
