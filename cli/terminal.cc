// SPDX-License-Identifier: MIT
#include "batten/cli/terminal.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <thread>

#include "batten/cli/program.h"
#include "batten/cli/progress_bar.h"
#include "batten/io/atomic_file.h"

namespace batten {
namespace {

volatile std::sig_atomic_t interrupted = 0;

extern "C" void NoteInterrupt(int) { interrupted = 1; }

bool Draws(bool quiet) { return !quiet && BarPossible(); }

bool TakesColour(Stream stream) {
  const char* const none = std::getenv("NO_COLOR");
  if (none != nullptr && *none != '\0') return false;
  const char* const terminal = std::getenv("TERM");
  if (terminal == nullptr || std::strcmp(terminal, "dumb") == 0) return false;
  return ::isatty(stream == Stream::kOutput ? STDOUT_FILENO : STDERR_FILENO) != 0;
}

}  // namespace

void WatchForInterrupt() {
  struct sigaction action {};
  action.sa_handler = NoteInterrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // Work looks at the flag where it can; this thread makes sure of the promised second.
  std::thread([] {
    constexpr auto kLook = std::chrono::milliseconds(20);
    constexpr auto kPatience = std::chrono::milliseconds(500);
    while (!interrupted) std::this_thread::sleep_for(kLook);
    std::this_thread::sleep_for(kPatience);
    AtomicFile::RemoveTemporaries();
    PrintError("interrupted; nothing was written");
    _exit(kInterrupted);
  }).detach();
}

bool Interrupted() { return interrupted != 0; }

Progress MakeProgress(bool quiet) {
  return [draw = Draws(quiet)](const char* stage, double fraction) {
    if (Interrupted()) return false;
    if (draw) NoteProgress(stage, fraction);
    return true;
  };
}

void BeginReading(const std::vector<std::string>& paths, bool quiet) {
  if (!Draws(quiet)) return;
  double bytes = 0;
  for (const std::string& path : paths) {
    std::error_code unknown;  // of a pipe, or of no file at all: reading says what is wrong
    const auto size = std::filesystem::file_size(path, unknown);
    if (!unknown) bytes += static_cast<double>(size);
  }
  SetProgressAmount("read", bytes, "B");
  NoteProgress("read", 0);
}

void TellAmount(const char* stage, double total, const char* unit, bool quiet) {
  if (Draws(quiet)) SetProgressAmount(stage, total, unit);
}

void ClearProgress() { HideBar(); }

void PrintWarning(const std::string& text) {
  ClearProgress();
  WriteToErrors("batten: " + Toned("warning:", Tone::kWarning, Stream::kErrors) + ' ' + text +
                '\n');
}

void PrintError(const std::string& text) {
  ClearProgress();
  std::string line = text;
  std::replace(line.begin(), line.end(), '\n', ' ');
  WriteToErrors(Toned("batten:", Tone::kError, Stream::kErrors) + ' ' + line + '\n');
}

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

}  // namespace batten
