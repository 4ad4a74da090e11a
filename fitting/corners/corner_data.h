// SPDX-License-Identifier: MIT
// Inliers and arc lengths for the search for corners. Used by it only.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/corners/corner_options.h"

namespace batten::internal {

// The inliers and their arc lengths along the curve.
struct CornerData {
  Eigen::Matrix3Xd points;
  Eigen::VectorXd lengths;     // from 0, in the units of the points
  Eigen::VectorXd parameters;  // as given
  double length = 0;           // of all, with the way back to the first where it is closed
  double range = 0;            // the same of the parameters

  double ParameterAt(double place) const;  // 0 ≤ place ≤ length
};

// Returns the indices of the inliers. Outliers are points far from the median of themselves and
// three neighbours on either side, compared with the noise and with steps. O(m).
std::vector<Eigen::Index> WithoutOutliers(const Eigen::Matrix3Xd& points,
                                          const CornerOptions& options);

// Removes outliers and computes arc lengths: those of the steps where noise is small against them;
// else parameters become lengths by one factor, from the polyline of block means, and the detours
// that they took to outliers are left out. O(m).
CornerData CornerDataOf(const Eigen::Matrix3Xd& points,
                        const Eigen::VectorXd& parameters,
                        const CornerOptions& options);

}  // namespace batten::internal
