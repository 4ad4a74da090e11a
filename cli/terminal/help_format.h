// SPDX-License-Identifier: MIT
// Help as people read it: lines that fit, flags under headings.
#pragma once

#include <string>
#include <vector>

#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// "  name    text", the text from that column on, wrapped at 100 columns.
std::string HelpLines(const std::string& name, const std::string& text, size_t column);

// Descriptions in help, of the command and those added to it later, are wrapped at 100 columns.
void WrapHelp(CLI::App& app);

// What help says of flags or arguments, in the order in which it stands there.
struct HelpEntry {
  std::string name, text;  // "--loss LOSS=auto"; as it was given, lines unwrapped
};
struct HelpGroup {
  std::string heading;  // "Options"
  std::vector<HelpEntry> entries;
};
std::vector<HelpGroup> HelpGroups(const CLI::App& command);

// "batten fit surface [OPTIONS] CLOUD..."
std::string HelpUsage(const CLI::App& command, const std::string& full_name);

// Flags that stand under a heading; those the command does not have are passed by.
void GroupFlags(CLI::App& command,
                const std::string& heading,
                const std::vector<std::string>& flags);

}  // namespace batten::internal
