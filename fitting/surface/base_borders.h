// SPDX-License-Identifier: MIT
// The points beside the borders of the rectangle that a base has.
#pragma once

#include <cstdint>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/surface/surface_preparation.h"

namespace batten::internal {

// Whether the points fill the rectangle of the parameterization. Foot points on a coarse surface
// may later leave a protruding part of it empty.
bool FillBase(const PreparedCloud& prepared, const PointMask& used, ThreadPool& pool);

// Of each used point, 1 where it lies beside a border in u, 2 beside one in v, 3 both. Where points
// fill the rectangle these are the sheet's own border, which a surface should end at: were they
// free to move across it, the edges of a coarse net would wander in and out of the points.
std::vector<std::uint8_t> BesideBorders(const PreparedCloud& prepared, const PointMask& used);

}  // namespace batten::internal
