// SPDX-License-Identifier: MIT
// The corners that a curve's fit gets, in the parameters of its points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/ordered_points.h"

namespace batten::internal {

struct FitCorners {
  std::vector<double> parameters;  // sharpest first; of a closed curve one is at the seam
  // Points at corners, where points follow the curve closely: each holds its corner. Between sides
  // that hardly part nothing else would.
  std::vector<Eigen::Index> anchored;
  // So few points that they were taken as exact: what looks like their noise may be their corners.
  bool sought_as_exact = false;
  Eigen::VectorXd data;  // the points' parameters, moved so that the seam is at the sharpest corner
};

// Whether points scatter about the curve by far less than they are apart.
bool FollowsClosely(const OrderedPoints& ordered);

// Corners by curve_corners.h, without those that have hardly a point between them, nor those beyond
// the sharpest that so many control points allow.
FitCorners CornersForFit(const OrderedPoints& ordered, int degree, int most_control_points);

}  // namespace batten::internal
