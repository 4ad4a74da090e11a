// SPDX-License-Identifier: MIT
#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

#include "cli/commands/program.h"

namespace {

// Memory that was given back is kept: fits ask for large arrays again and again, and pages that are
// returned to the system cost a fault each (of ten million points a fifth of all time).
void KeepMemory() {
#ifdef M_MMAP_MAX
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, -1);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  KeepMemory();
  return batten::internal::RunProgram(argc, argv);
}
