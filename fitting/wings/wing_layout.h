// SPDX-License-Identifier: MIT
// Parameters of a thin closed section with a sharp edge: a wing, a blade, a fin, a strut.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "batten/fitting/neighbours.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct WingParameters {
  Eigen::Matrix2Xd parameters;  // (2 × m) in [0, length_u] × [0, length_v]: u from the edge round
                                // the nose to the edge, v from tip to tip
  double length_u = 0, length_v = 0;
  std::optional<NurbsCurve<3>> edge;  // over [0, length_v]: u = 0 and u = length_u
  std::string failure_reason;

  bool ok() const { return failure_reason.empty(); }
};

// Lays points of a thin closed section, open at both tips, as one sheet round its nose, which
// closes at its sharp edge. Sides are told apart by normals (TellSidesApart); the edge and the tips
// are where points end (EndOfPoints), and the rectangle ends by `margin` beyond the tips. Points
// near the edge, where noise hides their side, get one by its probability, so that the sheets are
// pushed neither apart nor together. Refuses sections whose sides do not meet in a sharp edge along
// the whole span. `noise` is the points' standard deviation along the normal. The same for every
// number of threads. O(m log m).
WingParameters LayWing(const Eigen::Matrix3Xd& points,
                       const NeighbourIndex& index,
                       double noise,
                       double margin,
                       ThreadPool& pool);

}  // namespace batten::internal
