// SPDX-License-Identifier: MIT
// From the places of nodes in the plane to those of all points of a sheet.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/flattening/arap_flattening.h"
#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

struct SpreadPlaces {
  Eigen::Matrix2Xd places;
  PointMask reached;  // false where no node is near enough to speak for the point, or the point is
                      // off the sheet there: a guess
};

// Every node maps the points around it: to their feet on the node's quadric, along it to lengths
// in the node's tangent plane, and by the node's linear map into the plane. A point's place is the
// mean of what the nodes around it say, with weights that fall smoothly to nothing at twice a
// node's reach: a smooth function of the point, in which its distance from the sheet does not
// show to first order. Only nodes along the sheet from the point's best one speak: of the nearest
// six the one of least d/r + 2 |normal offset|/r. On a tube places come out near those of the
// nodes, be it a little outside the period. `noise` is the standard deviation of the points along
// the normal. O(m log n).
SpreadPlaces BlendLocalCharts(const SheetGraph& graph,
                              const Flattening& unfolding,
                              const Eigen::Matrix3Xd& points,
                              double noise,
                              ThreadPool& pool);

}  // namespace batten::internal
