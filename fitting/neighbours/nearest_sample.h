// SPDX-License-Identifier: MIT
// Nearest of a few hundred places of the plane, by linear search.
#pragma once

#include <cstddef>

namespace batten::internal {

inline constexpr std::ptrdiff_t kSampleLanes = 8;

// Returns the index of the sample (x, y) nearest to a place, of equally near ones the first.
// `count`, the length of either array, is a positive multiple of kSampleLanes; padding is infinite.
// Compiled for several instruction sets. O(count).
std::ptrdiff_t NearestSample(
    const double* x, const double* y, std::ptrdiff_t count, double at_x, double at_y);

}  // namespace batten::internal
