// SPDX-License-Identifier: MIT
// Smoothing of a border: one closed cubic spline with corners.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "fitting/outline/outline_loop.h"

namespace batten::internal {

inline constexpr int kOutlineDegree = 3;

// A closed cubic spline. Control point i is column unknown[i] of `points`; coinciding control
// points share a column. With corners the basis is clamped and begins at a corner; without, it is
// periodic.
struct OutlineSpline {
  SplineBasis basis;
  std::vector<int> unknown;
  Eigen::Matrix2Xd points;
  std::vector<std::array<bool, 2>> fixed;  // coordinates of columns that must not move
  std::vector<double> corners;             // their parameters
  std::vector<char> straight;  // the piece from this corner to the next is a line along a cut
  std::vector<char> pinned;    // the piece from this corner to the next is a line that stays

  Eigen::Vector2d At(double t) const;
  bool IsStraight(double t) const;
  NurbsCurve<2> Curve(double scale) const;  // clamped
};

// Fits cubics to the samples, straight lines where a border runs along a cut; parameters are
// lengths. Schwarz' criterion chooses the number of control points, usually few; detail below
// `noise` (in spacings) is not followed. O(length · log(control points)).
OutlineSpline SmoothedOutline(const OutlineLoop& loop, double noise);

}  // namespace batten::internal
