// SPDX-License-Identifier: MIT
#include "cli/terminal/streams.h"

#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace batten::internal {
namespace {

bool TakesColour(Stream stream) {
  const char* const none = std::getenv("NO_COLOR");
  if (none != nullptr && *none != '\0') return false;
  const char* const terminal = std::getenv("TERM");
  if (terminal == nullptr || std::strcmp(terminal, "dumb") == 0) return false;
  return ::isatty(stream == Stream::kOutput ? STDOUT_FILENO : STDERR_FILENO) != 0;
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

std::string WithVerdict(const std::string& line, bool reached) {
  const size_t sign = line.rfind("; ");
  const size_t begin = sign == std::string::npos ? line.size() : sign + 2;
  if (begin == line.size()) return line;
  return line.substr(0, begin) +
         Toned(line.substr(begin), reached ? Tone::kGood : Tone::kShort, Stream::kOutput);
}

}  // namespace batten::internal
