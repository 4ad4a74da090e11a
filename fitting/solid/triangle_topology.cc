// SPDX-License-Identifier: MIT
#include "fitting/solid/triangle_topology.h"

#include <Eigen/Geometry>
#include <cstdint>
#include <unordered_map>

#include "batten/fitting/refused_data.h"

namespace batten::internal {

TriangleTopology::TriangleTopology(const TriangleSurface& surface)
    : corners_(surface.triangles),
      twin_(std::size_t(3 * surface.triangles.cols()), -1),
      outgoing_(std::size_t(surface.vertices.cols()), -1) {
  const auto key = [](int a, int b) { return std::int64_t{a} << 32 | std::uint32_t(b); };
  std::unordered_map<std::int64_t, int> directed;
  directed.reserve(twin_.size());
  for (int h = 0; h < half_edges(); ++h) {
    outgoing_[std::size_t(Origin(h))] = h;
    if (!directed.try_emplace(key(Origin(h), Origin(Next(h))), h).second) {
      throw RefusedData("more than two triangles meet at an edge");
    }
  }
  for (int h = 0; h < half_edges(); ++h) {
    const auto found = directed.find(key(Origin(Next(h)), Origin(h)));
    if (found == directed.end()) throw RefusedData("the surface is open");
    twin_[std::size_t(h)] = found->second;
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
