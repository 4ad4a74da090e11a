// SPDX-License-Identifier: MIT
// The refusal of a broken precondition.
#pragma once

#include <stdexcept>
#include <string>

namespace batten::internal {

// Throws std::invalid_argument: the function or type whose precondition is broken, and its rule.
[[noreturn]] inline void Reject(const std::string& function, const std::string& rule) {
  throw std::invalid_argument(function + ": " + rule);
}

}  // namespace batten::internal
