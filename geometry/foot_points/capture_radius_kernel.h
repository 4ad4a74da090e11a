// SPDX-License-Identifier: MIT
// The inner loop of CaptureRadius, compiled for several instruction sets. Plain pointers only.
#pragma once

#include <cstddef>

namespace batten::internal {

inline constexpr int kReachLanes = 8;

// Ranges of scalar products with two directions.
struct TangentRanges {
  double low[2], high[2];
};

// Widens the ranges by the vectors of several sets, `stride` numbers from one to the next: x, y, z
// by rows of `padded` numbers, a multiple of kReachLanes.
void WidenRanges(const double* sets,
                 int count,
                 std::ptrdiff_t stride,
                 int padded,
                 const double* first,
                 const double* second,
                 TangentRanges& ranges);

}  // namespace batten::internal
