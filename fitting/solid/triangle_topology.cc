// SPDX-License-Identifier: MIT
#include "fitting/solid/triangle_topology.h"

#include <Eigen/Geometry>
#include <utility>

#include "batten/fitting/refused_data.h"

namespace batten::internal {

TriangleTopology::TriangleTopology(const TriangleSurface& surface)
    : corners_(surface.triangles), outgoing_(std::size_t(surface.vertices.cols()), -1) {
  HalfEdges edges = LinkTriangles(corners_, vertices());
  if (!edges.crowded.empty()) throw RefusedData("more than two triangles meet at an edge");
  twin_ = std::move(edges.twin);
  for (int h = 0; h < half_edges(); ++h) {
    outgoing_[std::size_t(Origin(h))] = h;
    if (Twin(h) < 0) throw RefusedData("the surface is open");
    if (Origin(h) == Origin(Twin(h))) throw RefusedData("two triangles run along an edge alike");
  }
}

std::vector<std::complex<double>> PlanarEdges(const TriangleSurface& surface) {
  std::vector<std::complex<double>> planar;
  planar.reserve(std::size_t(3 * surface.triangles.cols()));
  for (const auto t : surface.triangles.colwise()) {
    const Eigen::Vector3d along = surface.vertices.col(t[1]) - surface.vertices.col(t[0]);
    const Eigen::Vector3d other = surface.vertices.col(t[2]) - surface.vertices.col(t[0]);
    const double length = along.norm();
    const std::complex<double> third(along.dot(other) / length, along.cross(other).norm() / length);
    planar.push_back(length);
    planar.push_back(third - length);
    planar.push_back(-third);
  }
  return planar;
}

}  // namespace batten::internal
