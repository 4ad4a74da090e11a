// SPDX-License-Identifier: MIT
// A corner of a curve, and the options of the search for corners.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// A place of a curve where the tangents of both sides differ: the curve is continuous, its
// direction is not.
struct CurveCorner {
  double parameter;       // in the units of the given parameters
  double angle;           // by which the direction turns, 0 … π
  Eigen::Vector3d place;  // where both sides meet
};

struct CornerOptions {
  double noise = 0;                          // standard deviation of a coordinate, ≥ 0; 0: exact.
                                             // More is taken where points clearly show more.
  bool closed = false;                       // the last point is followed by the first
  double period = 0;                         // of the parameters of a closed curve, > 0
  double least_angle = 0.52359877559829887;  // 30°; in (0, π)
};

// Throws std::invalid_argument naming the field whose value breaks its rule.
void Check(const CornerOptions& options);

}  // namespace batten::internal
