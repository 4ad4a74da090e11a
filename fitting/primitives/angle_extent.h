// SPDX-License-Identifier: MIT
// The angular range that points cover on a circle.
#pragma once

#include <vector>

#include "batten/geometry/frame.h"

namespace batten::internal {

// The widest gap between neighbours round the circle.
struct AngleGap {
  double width = 0, end = 0;  // no width where there are no angles
  double rest = 0;            // the range of them all, from the gap's end
};

// Of angles in [−π, π], in linear time; gaps below a 4096th of the circle may be missed.
AngleGap WidestGapOf(const std::vector<double>& angles);

// The range that one angle or more in [−π, π] cover: the full circle, from the first of them, where
// they lie all round it, else everything but the widest gap.
AngleRange ArcCovered(const std::vector<double>& angles);

// The same with a start in [0, 2π); the full circle from 0.
AngleRange AnglesCovered(const std::vector<double>& angles);

}  // namespace batten::internal
