// SPDX-License-Identifier: MIT
#include "cli/terminal/this_run.h"

#include "cli/terminal/shell_words.h"

namespace batten::internal {
namespace {

std::string command_line;
bool doubtful = false;

}  // namespace

const char* Version() { return BATTEN_VERSION; }

void KeepCommandLine(const std::string& program, const std::vector<std::string>& words) {
  command_line = ShellWord(program);
  for (const std::string& word : words) command_line += " " + ShellWord(word);
}

const std::string& CommandLine() { return command_line; }

void NoteDoubt() { doubtful = true; }

bool Doubtful() { return doubtful; }

}  // namespace batten::internal
