// SPDX-License-Identifier: MIT
// Numbers that look random and depend on their arguments only.
#pragma once

#include <bit>
#include <cstdint>

namespace batten::internal {

// Well mixed bits of a number. [Steele, Lea & Flood 2014, SplitMix64]
inline std::uint64_t Mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

// The bits of a place's three coordinates, mixed; those of −0 are those of 0.
inline std::uint64_t MixedBitsOf(const double* place, std::uint64_t seed = 0) {
  for (int d = 0; d < 3; ++d) seed = Mixed(seed ^ std::bit_cast<std::uint64_t>(place[d] + 0.0));
  return seed;
}

}  // namespace batten::internal
