// SPDX-License-Identifier: MIT
#include "cli/terminal/streams.h"

#include <sys/types.h>
#include <unistd.h>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace batten::internal {
namespace {

bool TakesColour(Stream stream) {
  const char* const none = std::getenv("NO_COLOR");
  if (none != nullptr && *none != '\0') return false;
  const char* const terminal = std::getenv("TERM");
  if (terminal == nullptr || std::strcmp(terminal, "dumb") == 0) return false;
  return ::isatty(stream == Stream::kOutput ? STDOUT_FILENO : STDERR_FILENO) != 0;
}

// Bytes of the UTF-8 character that begins there; 0 where none does.
size_t CharacterLength(const std::string& text, size_t at) {
  const auto byte = [&](size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char first = byte(at);
  const size_t length = first < 0x80                    ? 1
                        : first >= 0xc2 && first < 0xe0 ? 2
                        : first >= 0xe0 && first < 0xf0 ? 3
                        : first >= 0xf0 && first < 0xf5 ? 4
                                                        : 0;
  if (length == 0 || at + length > text.size()) return 0;
  for (size_t k = at + 1; k < at + length; ++k)
    if ((byte(k) & 0xc0) != 0x80) return 0;
  return length;
}

// Whether a character moves a terminal: C0, DEL, C1, line separators, marks of writing direction.
bool IsControl(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return first < 0x20 || first == 0x7f;
  if (character.size() == 2)
    return first == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0;
  return (character >= "\u2028" && character <= "\u202e") ||
         (character >= "\u2066" && character <= "\u2069") || character == "\u200e" ||
         character == "\u200f";
}

}  // namespace

void WriteToErrors(const std::string& text) {
  for (size_t at = 0; at < text.size();) {
    const ssize_t written = ::write(STDERR_FILENO, text.data() + at, text.size() - at);
    if (written <= 0 && errno != EINTR) return;
    if (written > 0) at += static_cast<size_t>(written);
  }
}

std::string Toned(const std::string& text, Tone tone, Stream stream) {
  if (!TakesColour(stream)) return text;
  const char* const colour = tone == Tone::kError  ? "\033[1;31m"
                             : tone == Tone::kGood ? "\033[32m"
                                                   : "\033[33m";
  return colour + text + "\033[0m";
}

std::string Printable(const std::string& text) {
  std::string printable;
  for (size_t at = 0; at < text.size();) {
    const size_t length = CharacterLength(text, at);
    const std::string_view character(text.data() + at, std::max<size_t>(length, 1));
    at += character.size();
    if (character == "\n") {
      printable += "\\n";
    } else if (character == "\t") {
      printable += "\\t";
    } else if (length > 0 && !IsControl(character)) {
      printable += character;
    } else {
      for (const char byte : character)
        printable += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
    }
  }
  return printable;
}

void PrintResult(const std::string& line) { fmt::print("{}\n", Printable(line)); }

void PrintVerdict(const std::string& text, bool reached) {
  const std::string line = Printable(text);
  const size_t sign = line.rfind("; ");
  const size_t begin = sign == std::string::npos ? line.size() : sign + 2;
  const std::string verdict = line.substr(begin);
  fmt::print("{}{}\n",
             line.substr(0, begin),
             verdict.empty()
                 ? verdict
                 : Toned(verdict, reached ? Tone::kGood : Tone::kShort, Stream::kOutput));
}

}  // namespace batten::internal
