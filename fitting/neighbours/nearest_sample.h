// SPDX-License-Identifier: MIT
// The nearest of a few hundred places of the plane.
#pragma once

#include <cstddef>

namespace batten::internal {

inline constexpr std::ptrdiff_t kSampleLanes = 8;

// Index of the sample (x, y) nearest to a place, of equally near ones the first. `count`, a
// multiple of kSampleLanes and not 0, is that of either array; what fills them up is to be
// infinite. Compiled for several instruction sets. O(count).
std::ptrdiff_t NearestSample(
    const double* x, const double* y, std::ptrdiff_t count, double at_x, double at_y);

}  // namespace batten::internal
