// SPDX-License-Identifier: MIT
// Quadratic charts of a map that is known at the nodes of a sheet.
#pragma once

#include <Eigen/Core>

#include "fitting/flattening/arap_flattening.h"
#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

// Fits to the places of the nodes at most two edges away from each node, by weights that fall with
// distance, a quadratic of their coordinates in its tangent plane, lengths along the arc. Where
// nodes are few, or on a line, the quadratic is nearly linear. The map's `places` become the
// charts' own at their nodes: small jumps from node to node are smoothed. O(n).
Flattening QuadraticCharts(const SheetGraph& graph, const Eigen::VectorXcd& places);

}  // namespace batten::internal
