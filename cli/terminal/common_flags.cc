// SPDX-License-Identifier: MIT
#include "cli/terminal/common_flags.h"

#include <limits>

#include "cli/terminal/cli11.h"
#include "cli/terminal/parse_values.h"

namespace batten::internal {

void AddCommonFlags(CLI::App& command, CommonFlags& flags) {
  command.add_flag("--quiet", flags.quiet, "Print nothing but errors");
  command.add_flag("--json", flags.json, "Make standard output one JSON object");
}

void AddThreadsFlag(CLI::App& command, int& threads) {
  constexpr int kMostThreads = 1024;
  command
      .add_option_function<std::string>(
          "--threads",
          [&threads](const std::string& text) {
            threads = static_cast<int>(ParseWhole("--threads", text, 1, kMostThreads));
          },
          "Threads to use [all cores]")
      ->type_name("N");
}

void AddWorkFlags(CLI::App& command, WorkFlags& flags) {
  AddThreadsFlag(command, flags.threads);
  AddSeedFlag(command, flags.seed, "Seed of every random choice");
}

void AddSeedFlag(CLI::App& command, std::uint64_t& seed, const std::string& what) {
  command
      .add_option_function<std::string>(
          "--seed",
          [&seed](const std::string& text) {
            seed = ParseWhole("--seed", text, 0, std::numeric_limits<std::uint64_t>::max());
          },
          what)
      ->type_name("N")
      ->default_str(std::to_string(seed));
}

}  // namespace batten::internal
