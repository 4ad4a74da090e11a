// SPDX-License-Identifier: MIT
// Selection of the corners that a curve fit keeps.
#pragma once

#include "fitting/curve/curve_task.h"

namespace batten::internal {

// Finds the corners where the options ask for them, without those that have too few points between
// them, and at most as many, the sharpest, as the control points allow. The seam of a closed curve
// moves to the sharpest.
void FindCorners(CurveTask& task);

}  // namespace batten::internal
