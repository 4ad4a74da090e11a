// SPDX-License-Identifier: MIT
// Scattered points made ready for windows. Used by the search for corners only.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/corners/corner_options.h"

namespace batten::internal {

// The points that are no outliers, and where they stand along the curve.
struct CornerData {
  Eigen::Matrix3Xd points;
  Eigen::VectorXd lengths;     // from 0, in the units of the points
  Eigen::VectorXd parameters;  // as given
  double length = 0;           // of all, with the way back to the first where it is closed
  double range = 0;            // the same of the parameters

  double ParameterAt(double place) const;  // 0 ≤ place ≤ length
};

// Indices of the points that are no outliers: far from the median of themselves and three
// neighbours on either side, compared with the noise and with steps. O(m).
std::vector<Eigen::Index> WithoutOutliers(const Eigen::Matrix3Xd& points,
                                          const CornerOptions& options);

// Lengths are those of the steps where noise is small against them. Else parameters become lengths
// by one factor, from the polyline of block means, and the detours that they took to outliers are
// left out. O(m).
CornerData CornerDataOf(const Eigen::Matrix3Xd& points,
                        const Eigen::VectorXd& parameters,
                        const CornerOptions& options);

}  // namespace batten::internal
