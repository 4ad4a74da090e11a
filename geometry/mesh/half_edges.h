// SPDX-License-Identifier: MIT
// Who is next to whom among triangles.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

// Half-edge 3t + k runs along triangle t from its corner k to corner k + 1.
inline int NextHalf(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
inline int PreviousHalf(int h) { return h % 3 == 0 ? h + 2 : h - 1; }

struct HalfEdges {
  // Of every half-edge the other one between the same two vertices, in whichever direction; −1:
  // there is none, or more than one.
  std::vector<int> twin;
  std::vector<std::vector<int>> crowded;  // three and more between the same two vertices, in order
};

// Of triangles of three vertex numbers below `vertices` each. O(n)
HalfEdges LinkTriangles(const Eigen::Ref<const Eigen::Matrix3Xi>& triangles, int vertices);

// Which triangles have the three vertices of one before them, in whichever order. O(n)
std::vector<bool> RepeatedTriangles(const Eigen::Ref<const Eigen::Matrix3Xi>& triangles,
                                    int vertices);

}  // namespace batten::internal
