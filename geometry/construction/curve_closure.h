// SPDX-License-Identifier: MIT
// Closed curves, open ones and points told apart; where closed ones begin.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// Whether all control points coincide, to rounding of their coordinates.
bool IsPoint(const NurbsCurve<3>& curve);

// Throws std::invalid_argument where one is closed and another open, naming both, by numbers from 1
// on, and the gap between the ends of the open one. Points are neither. `noun` is what the curves
// are called.
void RequireSameClosedness(const std::vector<NurbsCurve<3>>& curves,
                           const char* function,
                           const char* noun);

// The closed curve begun at the parameter `at` inside its domain, over a domain as long.
NurbsCurve<3> BegunAt(const NurbsCurve<3>& closed, double at);

}  // namespace batten::internal
