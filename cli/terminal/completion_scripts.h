// SPDX-License-Identifier: MIT
// The scripts that complete command lines in shells by asking `batten __complete WORD...`.
#pragma once

#include <string>

namespace batten::internal {

// Of bash, zsh or fish; null for any other.
const char* CompletionScript(const std::string& shell);

}  // namespace batten::internal
