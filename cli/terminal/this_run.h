// SPDX-License-Identifier: MIT
// Which program this is and how it was called, for reports.
#pragma once

#include <string>
#include <vector>

namespace batten::internal {

const char* Version();

// To be called once, before any work.
void KeepCommandLine(const std::string& program, const std::vector<std::string>& words);

// The command line kept, quoted so that a shell takes it again.
const std::string& CommandLine();

}  // namespace batten::internal
