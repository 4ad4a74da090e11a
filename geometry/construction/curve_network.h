// SPDX-License-Identifier: MIT
// A network of curves in two directions, put in order: who meets whom at which parameter.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// Curves of one direction of a network, in order, turned to run alike, on [0, 1] from the first to
// the last curve that they meet; where closed, from the first round to it again.
struct CurveFamily {
  std::vector<NurbsCurve<3>> curves;
  std::vector<int> order;  // curves[k] is the given one of this number
  Eigen::MatrixXd meets;   // (k, l): parameter at which curve k meets curve l of the other family
  bool closed = false;
};

struct CurveNetwork {
  CurveFamily along_u, along_v;
  Eigen::Matrix3Xd points;  // column k·(curves along v) + l: the middle of where k and l meet
  double gap = 0;           // largest distance of two curves where they meet
};

// Throws std::invalid_argument in the name of Gordon; see gordon_surface.h.
CurveNetwork NetworkOf(const std::vector<NurbsCurve<3>>& along_u,
                       const std::vector<NurbsCurve<3>>& along_v,
                       double tolerance);

}  // namespace batten::internal
