// SPDX-License-Identifier: MIT
// What distances of points from a curve or surface are told as.
#pragma once

#include <Eigen/Core>

namespace batten {

struct PointDistances {
  Eigen::VectorXd distances;   // signed along the surface normal; not negative for curves
  Eigen::MatrixXd parameters;  // of the foot points: 2 × m (u, v) or 1 × m (u)
  // Points of DistancesTo for which a nearer place may have been missed (SurfaceFoot::certified):
  // their distances are upper bounds.
  Eigen::Index uncertified = 0;
};

}  // namespace batten
