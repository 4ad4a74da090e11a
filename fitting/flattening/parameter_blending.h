// SPDX-License-Identifier: MIT
// Parameters of all points of a sheet, blended from the local charts of its flattened nodes.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/flattening/arap_flattening.h"
#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

struct SpreadPlaces {
  Eigen::Matrix2Xd places;
  PointMask reached;  // false if no node is near enough to the point, or the point lies off
                      // the sheet: its place is a guess
};

// Blends the local charts of the nodes. Each node maps the points around it to their foot points on
// the node's quadric, along it to lengths in the node's tangent plane, and by the node's map,
// linear or quadratic, into the plane. A point's place is the weighted mean over the nodes around
// it, with weights that fall smoothly to zero at twice a node's reach: a smooth function of the
// point, independent of its distance from the sheet to first order. Only nodes connected along the
// sheet with the point's best node contribute: of the nearest six the one of least d/r + 2 |normal
// offset|/r. On a tube places are near those of the nodes, possibly a little outside the period.
// `noise` is the standard deviation of the points along the normal. O(m log n).
SpreadPlaces BlendLocalCharts(const SheetGraph& graph,
                              const Flattening& unfolding,
                              const Eigen::Matrix3Xd& points,
                              double noise,
                              ThreadPool& pool);

}  // namespace batten::internal
