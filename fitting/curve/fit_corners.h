// SPDX-License-Identifier: MIT
// Selection of the corners that a curve fit keeps.
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
  // Whether corners were sought as in exact points because there are so few: their apparent noise
  // may be their corners.
  bool sought_as_exact = false;
  Eigen::VectorXd data;  // the points' parameters, moved so that the seam is at the sharpest corner
};

// Whether the noise of the points is far below their spacing.
bool FollowsClosely(const OrderedPoints& ordered);

// Finds corners by FindCorners, without those that have too few points between them, and at most as
// many, the sharpest, as `most_control_points` allows.
FitCorners CornersForFit(const OrderedPoints& ordered, int degree, int most_control_points);

}  // namespace batten::internal
