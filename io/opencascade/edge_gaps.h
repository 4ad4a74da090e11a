// SPDX-License-Identifier: MIT
// How far surfaces and edges are apart. Not installed; includes OpenCASCADE.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <optional>
#include <vector>

namespace batten::internal {

// The largest distance between two faces along an edge they share, at 33 places.
double GapAlong(const TopoDS_Edge& edge, const TopoDS_Face& first, const TopoDS_Face& second);

// Of every edge's largest distance from another one, at five places, the least; none of fewer than
// two edges. Of more than 400 edges the first 400 count.
std::optional<double> NearestGap(const std::vector<TopoDS_Edge>& edges);

}  // namespace batten::internal
