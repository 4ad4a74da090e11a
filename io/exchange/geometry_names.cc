// SPDX-License-Identifier: MIT
#include "io/exchange/geometry_names.h"

#include <cstdint>
#include <cstdio>

namespace batten::internal {
namespace {

struct Character {
  std::uint32_t code;
  size_t bytes;  // 0: the bytes are not UTF-8
};

// The character that begins at `at`. [RFC 3629, §4]
Character Decode(std::string_view text, size_t at) {
  const auto byte = [&](size_t k) { return static_cast<unsigned char>(text[at + k]); };
  const std::uint32_t first = byte(0);
  if (first < 0x80) return {first, 1};
  const size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || at + bytes > text.size()) return {0, 0};
  std::uint32_t code = first & (0xFFu >> (bytes + 1));
  for (size_t k = 1; k < bytes; ++k) {
    if ((byte(k) & 0xC0) != 0x80) return {0, 0};
    code = code << 6 | (byte(k) & 0x3Fu);
  }
  constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  if (code < kLeast[bytes] || code > 0x10FFFF || surrogate) return {0, 0};
  return {code, bytes};
}

bool IsUtf8(std::string_view text) {
  for (size_t at = 0; at < text.size();) {
    const size_t bytes = Decode(text, at).bytes;
    if (bytes == 0) return false;
    at += bytes;
  }
  return true;
}

std::string Hex(std::uint32_t code, int digits) {
  char text[16];
  std::snprintf(text, sizeof text, "%0*X", digits, static_cast<unsigned>(code));
  return text;
}

}  // namespace

std::string CleanName(std::string_view text) {
  constexpr size_t kLongest = 1000;
  const bool utf8 = IsUtf8(text);
  std::string name;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      name += ' ';
    } else if (byte < 0x80 || utf8) {
      name += c;
    } else {
      name += static_cast<char>(0xC0 | byte >> 6);
      name += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  const size_t begin = name.find_first_not_of(' ');
  if (begin == name.npos) return "";
  name = name.substr(begin, name.find_last_not_of(' ') - begin + 1);
  if (name.size() <= kLongest) return name;
  size_t end = kLongest;
  while ((static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;
  return name.substr(0, end);
}

std::string AsciiPart(std::string_view name, std::size_t length) {
  std::string part;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0) == 0x80) continue;  // a character goes on
    if (part.size() == length) break;
    part += byte < 0x80 ? c : '?';
  }
  return part;
}

std::string ToStepText(std::string_view text) {
  std::string result;
  for (size_t at = 0; at < text.size();) {
    const auto [code, bytes] = Decode(text, at);
    if (bytes == 0) {
      result += '?';
      ++at;
      continue;
    }
    if (code < 0x80) {
      result += static_cast<char>(code);
    } else {
      result += code < 0x10000 ? "\\X2\\" + Hex(code, 4) : "\\X4\\" + Hex(code, 8);
      result += "\\X0\\";
    }
    at += bytes;
  }
  return result;
}

std::string ToJsonText(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += std::string("\\") + c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      result += "\\u" + Hex(static_cast<unsigned char>(c), 4);
    } else {
      result += c;
    }
  }
  return result + '"';
}

}  // namespace batten::internal
