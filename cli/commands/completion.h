// SPDX-License-Identifier: MIT
// What could stand where the cursor is: commands, flags, words of flags, files. All from the
// commands' own declarations, so that nothing is offered that the program does not take.
#pragma once

#include <string>
#include <vector>

#include "cli/commands/commands.h"
#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

struct Completion {
  std::vector<std::string> words;  // in place of the last word typed; folders without a slash
  bool files = false;              // they are names of files and folders
  bool open = false;               // what is typed goes on after a word, without a blank
};

// `words` are those typed after the program's name up to the cursor, the last one as far as it is
// typed (perhaps empty). Bash splits words at '=' and ':', which then stand alone: words beside
// them are taken together again, and only what follows the last of them is completed.
Completion Complete(const CLI::App& app, std::vector<std::string> words);

// Answers the script's question `batten __complete WORD...` on standard output: a line that says
// "files", "open" or "words", then a line for each word.
void PrintCompletion(const CLI::App& app, const std::vector<std::string>& words);

// batten completion: prints the script.
void AddCompletionCommand(CLI::App& app, Action& action);

}  // namespace batten::internal
