// SPDX-License-Identifier: MIT
#include "io/mesh/vertex_numbers.h"

#include <cstddef>
#include <stdexcept>
#include <unordered_map>

namespace batten::internal {

std::vector<std::vector<std::int64_t>> VertexNumbers(const std::vector<SurfaceMesh>& meshes) {
  std::vector<std::vector<std::int64_t>> numbers;
  std::unordered_map<int, std::int64_t> of_joints;
  std::int64_t count = 0;
  for (const SurfaceMesh& one : meshes) {
    const auto vertices = static_cast<std::size_t>(one.mesh.vertices.cols());
    if (!one.joints.empty() && one.joints.size() != vertices) {
      throw std::invalid_argument("SurfaceMesh: joints: one for every vertex is needed");
    }
    std::vector<std::int64_t>& own = numbers.emplace_back();
    for (std::size_t k = 0; k < vertices; ++k) {
      const int joint = one.joints.empty() ? -1 : one.joints[k];
      own.push_back(joint < 0 ? count : of_joints.emplace(joint, count).first->second);
      if (own.back() == count) ++count;
    }
  }
  return numbers;
}

}  // namespace batten::internal
