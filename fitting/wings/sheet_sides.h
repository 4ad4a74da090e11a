// SPDX-License-Identifier: MIT
// The sides of a thin section told apart: which points lie on a sheet, and to which side it faces.
#pragma once

#include <Eigen/Core>
#include <string>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/point_mask.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct SheetSides {
  PointMask labelled;        // points that clearly lie on one sheet
  PointMask moat;            // others that lie between two sheets that face away from each other
  Eigen::Matrix3Xd normals;  // (3 × m) of the labelled points, of length 1, outwards
  double spacing = 0;        // median distance to the sixth neighbour
  std::string failure_reason;

  bool ok() const { return failure_reason.empty(); }
};

// Tells sides apart by consistently oriented normals, not by nearness. The core, points with flat
// neighbourhoods that agree on their normals, hangs together round a nose, or falls into two sheets
// where the nose is too sharp for the points; then labels grow into the moat where two sheets
// approach each other: a point takes the side of the quadric through labelled neighbours of one
// side that it is near, if it is clearly off the other's. Points where both are within some six
// times the noise stay unlabelled. `noise` is the points' standard deviation along the normal. The
// same for every number of threads. O(m log m).
SheetSides TellSidesApart(const Eigen::Matrix3Xd& points,
                          const NeighbourIndex& index,
                          double noise);

}  // namespace batten::internal
