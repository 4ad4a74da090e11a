// SPDX-License-Identifier: MIT
// The program: the command line in, an exit code out.
#pragma once

namespace batten::internal {

// Parses and runs; everything an exception can mean becomes one line on standard error and a code.
int RunProgram(int argc, char** argv);

}  // namespace batten::internal
