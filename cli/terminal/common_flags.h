// SPDX-License-Identifier: MIT
// Flags that many commands share.
#pragma once

#include <cstdint>
#include <string>

#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// Flags every command has.
struct CommonFlags {
  bool quiet = false;  // errors only
  bool json = false;   // standard output is one JSON object
};
void AddCommonFlags(CLI::App& command, CommonFlags& flags);

void AddThreadsFlag(CLI::App& command, int& threads);  // 0 stands for all cores

// Flags of the commands that compute for long.
struct WorkFlags {
  int threads = 0;  // 0: all cores
  std::uint64_t seed = 1;
};
void AddWorkFlags(CLI::App& command, WorkFlags& flags);
void AddSeedFlag(CLI::App& command, std::uint64_t& seed, const std::string& what);

}  // namespace batten::internal
