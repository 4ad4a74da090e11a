// SPDX-License-Identifier: MIT
#include "batten/cli/terminal.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>

#include "batten/cli/program.h"
#include "batten/io/atomic_file.h"

namespace batten {
namespace {

volatile std::sig_atomic_t interrupted = 0;
bool bar_drawn = false;

extern "C" void NoteInterrupt(int) { interrupted = 1; }

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
    ClearProgress();
    PrintError("interrupted; nothing was written");
    _exit(kInterrupted);
  }).detach();
}

bool Interrupted() { return interrupted != 0; }

Progress MakeProgress(bool quiet) {
  const bool draw = !quiet && isatty(STDERR_FILENO) != 0;
  const auto start = std::chrono::steady_clock::now();
  return [draw, start, last = start](const char* stage, double fraction) mutable {
    const auto now = std::chrono::steady_clock::now();
    constexpr auto kQuietTime = std::chrono::seconds(1);
    constexpr auto kRedraw = std::chrono::milliseconds(100);
    if (draw && now - start > kQuietTime && now - last > kRedraw) {
      last = now;
      constexpr int kWidth = 30;
      const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kWidth);
      const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
      std::fprintf(stderr,
                   "\r%-14s [%s] %3.0f %%",
                   stage,
                   bar.c_str(),
                   100 * std::clamp(fraction, 0.0, 1.0));
      std::fflush(stderr);
      bar_drawn = true;
    }
    return !Interrupted();
  };
}

void ClearProgress() {
  if (!bar_drawn) return;
  std::fprintf(stderr, "\r%60s\r", "");
  std::fflush(stderr);
  bar_drawn = false;
}

void PrintWarning(const std::string& text) {
  ClearProgress();
  std::fprintf(stderr, "batten: warning: %s\n", text.c_str());
}

void PrintError(const std::string& text) {
  ClearProgress();
  std::string line = text;
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::fprintf(stderr, "batten: %s\n", line.c_str());
}

}  // namespace batten
