// SPDX-License-Identifier: MIT
// What a refused call says.
#pragma once

#include <stdexcept>
#include <string>

namespace batten::internal {

// The sentence of the std::invalid_argument that the call throws, `accepted` where it throws none.
template <typename Call>
std::string RefusalOf(const Call& call, const char* accepted = "accepted") {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return accepted;
}

}  // namespace batten::internal
