// SPDX-License-Identifier: MIT
#include "cli/terminal/this_run.h"

#include "cli/terminal/shell_words.h"

namespace batten::internal {
namespace {

std::string command_line;

}  // namespace

const char* Version() { return BATTEN_VERSION; }

void KeepCommandLine(int argc, const char* const* argv) {
  for (int k = 0; k < argc; ++k) command_line += (k > 0 ? " " : "") + ShellWord(argv[k]);
}

const std::string& CommandLine() { return command_line; }

}  // namespace batten::internal
