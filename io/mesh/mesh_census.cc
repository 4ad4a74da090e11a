// SPDX-License-Identifier: MIT
#include "batten/io/mesh_census.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "io/mesh/vertex_numbers.h"

namespace batten {
using namespace internal;

MeshCensus CensusOf(const std::vector<SurfaceMesh>& meshes) {
  const std::vector<std::vector<std::int64_t>> numbers = VertexNumbers(meshes);
  MeshCensus census;
  // Every edge as its ends, the lesser first, and the way a triangle runs along it.
  std::vector<std::pair<std::pair<std::int64_t, std::int64_t>, int>> edges;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    census.triangles += meshes[m].mesh.triangles.cols();
    for (const std::int64_t number : numbers[m]) {
      census.vertices = std::max<Eigen::Index>(census.vertices, number + 1);
    }
    for (const auto triangle : meshes[m].mesh.triangles.colwise()) {
      for (int e = 0; e < 3; ++e) {
        const std::int64_t from = numbers[m][static_cast<std::size_t>(triangle[e])];
        const std::int64_t to = numbers[m][static_cast<std::size_t>(triangle[(e + 1) % 3])];
        edges.emplace_back(std::minmax(from, to), from < to ? 1 : -1);
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t k = 0; k < edges.size();) {
    std::size_t end = k;
    int sum = 0;
    for (; end < edges.size() && edges[end].first == edges[k].first; ++end) {
      sum += edges[end].second;
    }
    if (end - k != 2 || sum != 0) ++census.open_edges;
    k = end;
  }
  return census;
}

}  // namespace batten
