// SPDX-License-Identifier: MIT
// The program: the command line in, an exit code out.
#pragma once

#include <string>
#include <vector>

namespace batten::internal {

// Parses and runs; everything an exception can mean becomes one line on standard error and a code.
int RunProgram(int argc, char** argv);

// Throws UsageError, with what the program would say, where words (without the program's name) are
// no command line. Nothing is done.
void CheckCommandLine(const std::vector<std::string>& words);

// Whether a flag ("--snap") of a command ("fit surface") takes no value; no where there is none.
bool FlagTakesNoValue(const std::string& command, const std::string& flag);

}  // namespace batten::internal
