// SPDX-License-Identifier: MIT
// Names of enumerators.
#pragma once

#include <array>
#include <cstddef>

namespace batten::internal {

// The name of an enumerator, of one for each from 0 to the last; "" of what is none of them.
template <auto kLast, std::size_t kCount>
const char* NameIn(const std::array<const char*, kCount>& names, decltype(kLast) value) {
  static_assert(kCount == static_cast<std::size_t>(kLast) + 1);
  const auto at = static_cast<std::size_t>(value);
  return at < kCount ? names[at] : "";
}

}  // namespace batten::internal
