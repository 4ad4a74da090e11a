// SPDX-License-Identifier: MIT
// Who is next to whom in a closed surface of triangles.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "batten/geometry/triangle_surface.h"
#include "geometry/mesh/half_edges.h"

namespace batten::internal {

// Of half-edges (half_edges.h), each with its triangle on the left.
class TriangleTopology {
 public:
  // Throws RefusedData where an edge does not belong to two triangles that run along it in opposite
  // directions.
  explicit TriangleTopology(const TriangleSurface& surface);

  int triangles() const { return static_cast<int>(corners_.cols()); }
  int vertices() const { return static_cast<int>(outgoing_.size()); }
  int half_edges() const { return 3 * triangles(); }

  static int Next(int h) { return NextHalf(h); }
  static int Previous(int h) { return PreviousHalf(h); }
  int Twin(int h) const { return twin_[std::size_t(h)]; }
  int Origin(int h) const { return corners_(h % 3, h / 3); }
  // The outgoing half-edge of the same vertex that follows counter-clockwise.
  int Turned(int h) const { return Twin(Previous(h)); }
  int Outgoing(int vertex) const { return outgoing_[std::size_t(vertex)]; }

 private:
  Eigen::Matrix3Xi corners_;
  std::vector<int> twin_, outgoing_;
};

// Every half-edge as a vector of its triangle's plane, whose real axis is the first half-edge.
std::vector<std::complex<double>> PlanarEdges(const TriangleSurface& surface);

}  // namespace batten::internal
