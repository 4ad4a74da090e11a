// SPDX-License-Identifier: MIT
// Which program this is and how it was called, for reports.
#pragma once

#include <string>

namespace batten::internal {

const char* Version();

// To be called once, before any work.
void KeepCommandLine(int argc, const char* const* argv);

// The command line kept, quoted so that a shell takes it again.
const std::string& CommandLine();

}  // namespace batten::internal
