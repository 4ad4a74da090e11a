// SPDX-License-Identifier: MIT
// The outline of points in a rectangle that is wider than they are.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/outline.h"

namespace batten::internal {

// FindOutline in the box of the points, a little widened, instead of the whole of
// [0, length_u] × [0, length_v]; directions that close, and v towards a pole, are left as they are. `fills`: the points fill that box.
Outline FindOutlineInBox(Eigen::Matrix2Xd parameters, OutlineOptions options, ThreadPool& pool);

}  // namespace batten::internal
