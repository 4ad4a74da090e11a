// SPDX-License-Identifier: MIT
// Which program this is, how it was called, for reports, and whether its result is in doubt.
#pragma once

#include <string>
#include <vector>

namespace batten::internal {

const char* Version();

// To be called once, before any work.
void KeepCommandLine(const std::string& program, const std::vector<std::string>& words);

// The command line kept, quoted so that a shell takes it again.
const std::string& CommandLine();

// What is written is but a part of what was asked: a command that would end with 0 ends doubtful.
void NoteDoubt();
bool Doubtful();

}  // namespace batten::internal
