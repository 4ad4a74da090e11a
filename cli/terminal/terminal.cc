// SPDX-License-Identifier: MIT
#include "cli/terminal/terminal.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>

#include "batten/io/atomic_file.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/interrupt.h"
#include "cli/terminal/progress_bar.h"
#include "cli/terminal/streams.h"

namespace batten::internal {
namespace {

std::string OnOneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return Printable(text);
}

std::atomic<int> patience{500};  // milliseconds

}  // namespace

void BePatient() { patience = 900; }

void WatchForInterrupt() {
  CatchSignals();
  // Work looks at the flag where it can; this thread makes sure of the promised second.
  std::thread([] {
    constexpr auto kLook = std::chrono::milliseconds(20);
    while (!Interrupted()) std::this_thread::sleep_for(kLook);
    std::this_thread::sleep_for(std::chrono::milliseconds(patience.load()));
    AtomicFile::RemoveTemporaries();
    PrintError("interrupted; nothing was written");
    _exit(kInterrupted);
  }).detach();
}

Progress MakeProgress(bool quiet) {
  return [draw = !quiet](const char* stage, double fraction) {
    if (Interrupted() || PastTimeLimit()) return false;
    if (draw) NoteProgress(stage, fraction);
    return true;
  };
}

void BeginReading(const std::vector<std::string>& paths, bool quiet) {
  if (quiet) return;
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
  if (!quiet) SetProgressAmount(stage, total, unit);
}

void ClearProgress() { HideBar(); }

void PrintNote(const std::string& text) {
  ClearProgress();
  WriteToErrors("batten: " + Printable(text) + '\n');
}

void PrintWarning(const std::string& text) {
  ClearProgress();
  WriteToErrors("batten: " + Toned("warning:", Tone::kWarning, Stream::kErrors) + ' ' +
                OnOneLine(text) + '\n');
}

void PrintError(const std::string& text) {
  ClearProgress();
  WriteToErrors(Toned("batten:", Tone::kError, Stream::kErrors) + ' ' + OnOneLine(text) + '\n');
}

}  // namespace batten::internal
