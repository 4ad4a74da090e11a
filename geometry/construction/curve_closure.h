// SPDX-License-Identifier: MIT
// Closed curves, open ones, points and lines told apart; where closed ones begin.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// Whether all control points coincide, to rounding of their coordinates.
bool IsPoint(const NurbsCurve<3>& curve);

// Whether all of these points lie on one line in the direction, to 1e-9 of their extent and of
// rounding of their coordinates.
bool LieAlong(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& direction);

// Throws std::invalid_argument where all control points of a surface lie on one line, to the same.
void RequireArea(const NurbsSurface& surface, const char* function);

// Throws std::invalid_argument where one is closed and another open, naming both, by numbers from 1
// on, and the gap between the ends of the open one. Points are neither. `noun` is what the curves
// are called.
void RequireSameClosedness(const std::vector<NurbsCurve<3>>& curves,
                           const char* function,
                           const char* noun);

// The closed curve begun at the parameter `at` inside its domain, over a domain as long.
NurbsCurve<3> BegunAt(const NurbsCurve<3>& closed, double at);

}  // namespace batten::internal
