// SPDX-License-Identifier: MIT
#include "cli/terminal/interrupt.h"

#include <csignal>

namespace batten::internal {
namespace {

volatile std::sig_atomic_t interrupted = 0;

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

}  // namespace batten::internal
