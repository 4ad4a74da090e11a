// SPDX-License-Identifier: MIT
// Points put in an order that keeps neighbours together, by halving.
#pragma once

#include <vector>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct PlacedPoint {
  float at[3];
  int id;
};

// Reorders points so that blocks of `leaf` · 2ⁿ from multiples of their size on are those of one
// half of their block of the next size, on one side across the widest side of its box. The same on
// any number of threads. O(m log m).
void HalveDownTo(std::vector<PlacedPoint>& points, int leaf, ThreadPool& pool);

}  // namespace batten::internal
