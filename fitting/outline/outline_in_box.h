// SPDX-License-Identifier: MIT
// The outline of points in their own bounding box rather than the whole parameter rectangle.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/outline.h"

namespace batten::internal {

// Runs FindOutline in the bounding box of the points, slightly widened, instead of the whole of [0,
// length_u] × [0, length_v]; periodic directions, and v towards a pole, keep their range. `fills`
// then means that the points fill that box.
Outline FindOutlineInBox(Eigen::Matrix2Xd parameters, OutlineOptions options, ThreadPool& pool);

// FillTheirRectangle of that box.
bool FillTheirBox(Eigen::Matrix2Xd parameters, OutlineOptions options, ThreadPool& pool);

}  // namespace batten::internal
