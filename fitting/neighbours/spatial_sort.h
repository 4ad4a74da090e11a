// SPDX-License-Identifier: MIT
// Spatial sort of points by recursive halving, which keeps neighbours together.
#pragma once

#include <vector>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct PlacedPoint {
  float at[3];
  int id;
};

// Reorders points by recursive halving: each block of `leaf` · 2ⁿ points, starting at a multiple of
// its size, is one half of a block of the next size, split across the widest side of that block's
// box. The same on any number of threads. O(m log m).
void HalveDownTo(std::vector<PlacedPoint>& points, int leaf, ThreadPool& pool);

}  // namespace batten::internal
