// SPDX-License-Identifier: MIT
#include "cli/terminal/shell_words.h"

#include <fmt/format.h>

#include <algorithm>

namespace batten::internal {
namespace {

bool IsPlain(unsigned char c) {
  constexpr std::string_view kSafe = "%+,-./:=@_";
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
         kSafe.find(static_cast<char>(c)) != std::string_view::npos;
}

// The length of the UTF-8 character that begins here; 0 where none does. [RFC 3629, §4]
std::size_t CharacterLength(std::string_view text) {
  const auto byte = [&](std::size_t k) -> unsigned {
    return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u;
  };
  const auto follows = [&](std::size_t k, unsigned low = 0x80, unsigned high = 0xbf) {
    return byte(k) >= low && byte(k) <= high;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf) return follows(1) ? 2 : 0;
  if (first >= 0xe0 && first <= 0xef) {
    const unsigned low = first == 0xe0 ? 0xa0 : 0x80, high = first == 0xed ? 0x9f : 0xbf;
    return follows(1, low, high) && follows(2) ? 3 : 0;
  }
  if (first >= 0xf0 && first <= 0xf4) {
    const unsigned low = first == 0xf0 ? 0x90 : 0x80, high = first == 0xf4 ? 0x8f : 0xbf;
    return follows(1, low, high) && follows(2) && follows(3) ? 4 : 0;
  }
  return 0;
}

bool IsControl(unsigned char c) { return c < 0x20 || c == 0x7f; }

bool NeedsEscapes(std::string_view word) {
  while (!word.empty()) {
    const std::size_t length = CharacterLength(word);
    if (length == 0 || IsControl(static_cast<unsigned char>(word[0]))) return true;
    word.remove_prefix(length);
  }
  return false;
}

std::string Escaped(std::string_view word) {
  std::string text = "$'";
  while (!word.empty()) {
    const std::size_t length = CharacterLength(word);
    const auto c = static_cast<unsigned char>(word[0]);
    if (length == 0 || IsControl(c)) {
      text += fmt::format("\\{:03o}", c);
    } else if (c == '\'' || c == '\\') {
      text += {'\\', static_cast<char>(c)};
    } else {
      text += word.substr(0, length);
    }
    word.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return text + "'";
}

}  // namespace

std::string ShellWord(std::string_view word) {
  const auto plain = [](char c) { return IsPlain(static_cast<unsigned char>(c)); };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return std::string(word);
  if (NeedsEscapes(word)) return Escaped(word);
  std::string text = "'";
  for (const char c : word) {
    if (c == '\'') {
      text += "'\\''";
    } else {
      text += c;
    }
  }
  return text + "'";
}

}  // namespace batten::internal
