// SPDX-License-Identifier: MIT
// The map of a triangulated sheet with four corners onto a rectangle.
#pragma once

#include <Eigen/Core>
#include <array>

#include "fitting/flattening/sheet_triangulation.h"

namespace batten::internal {

struct RectangleMap {
  Eigen::VectorXcd places;  // of the nodes, u + iv
  double length_u = 0, length_v = 0;
  int flipped = 0;  // triangles that are turned over
};

// Maps the sheet harmonically: sides onto the rectangle's by their length, from the corners, which
// are places in the longest loop; nodes inside to the mean of their neighbours with the cotangent
// weights of the triangles, negative ones set to nearly none. Such a map is one to one. Sides of
// the rectangle are as long as those of the sheet are on average; u runs along the longer ones.
// All nodes must belong to triangles. O(n^1.5). [Tutte 1963; Pinkall & Polthier 1993; Floater 1997]
RectangleMap MapOntoRectangle(const Eigen::Matrix3Xd& nodes,
                              const SheetTriangulation& sheet,
                              std::array<size_t, 4> corners);

}  // namespace batten::internal
