// SPDX-License-Identifier: MIT
#include "cli/terminal/interrupt.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>

namespace batten::internal {
namespace {

volatile std::sig_atomic_t interrupted = 0;

using Clock = std::chrono::steady_clock;
std::atomic<Clock::time_point> deadline{Clock::time_point::max()};

extern "C" void NoteInterrupt(int) { interrupted = 1; }

}  // namespace

void CatchSignals() {
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction inherited {};
    // Who started the program may have said that it does not end by this (nohup, "batten … &").
    if (sigaction(signal, nullptr, &inherited) == 0 && inherited.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = NoteInterrupt;
    sigaction(signal, &action, nullptr);
  }
  // A file that may not grow is an error of the write, not the end of the program.
  std::signal(SIGXFSZ, SIG_IGN);
}

bool Interrupted() { return interrupted != 0; }

void BeginTimeLimit(double seconds) {
  constexpr double kLongest = 1e9;  // thirty years
  deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double>(std::min(seconds, kLongest)));
}

void EndTimeLimit() { deadline = Clock::time_point::max(); }

bool PastTimeLimit() { return Clock::now() >= deadline.load(); }

}  // namespace batten::internal
