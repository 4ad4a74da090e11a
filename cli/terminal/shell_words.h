// SPDX-License-Identifier: MIT
// A command line as one would type it.
#pragma once

#include <string>
#include <string_view>

namespace batten::internal {

// The word as a POSIX shell reads it back: itself where nothing in it means something to a shell,
// else in single quotes, or in $'…' (bash, zsh, POSIX 2024) where it holds control characters or
// bytes that are not UTF-8.
std::string ShellWord(std::string_view word);

}  // namespace batten::internal
