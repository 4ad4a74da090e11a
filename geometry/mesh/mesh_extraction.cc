// SPDX-License-Identifier: MIT
#include "geometry/mesh/mesh_extraction.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>

namespace batten::internal {
namespace {

class MeshExtraction {
 public:
  MeshExtraction(const DomainMesh& mesh, const std::vector<int>& names)
      : mesh_(mesh), names_(names) {}

  ExtractedMesh Run() const {
    std::vector<int> numbers(names_.size(), -1);
    std::vector<int> used;
    std::vector<Eigen::Vector3i> triangles;
    std::vector<std::array<int, 3>> own;  // their vertices as they were before they got names
    for (const ConstrainedDelaunay::Triangle& triangle : mesh_.delaunay().triangles()) {
      if (!triangle.inside) continue;
      Eigen::Vector3i named;
      for (int e = 0; e < 3; ++e) named[e] = names_[triangle.vertices[e]];
      if (named[0] == named[1] || named[1] == named[2] || named[2] == named[0]) continue;
      for (int& vertex : named) {
        if (numbers[vertex] < 0) {
          numbers[vertex] = static_cast<int>(used.size());
          used.push_back(vertex);
        }
        vertex = numbers[vertex];
      }
      triangles.push_back(named);
      own.push_back(triangle.vertices);
    }
    TriangleMesh mesh;
    const auto count = static_cast<Eigen::Index>(used.size());
    mesh.vertices.resize(3, count);
    mesh.parameters.resize(2, count);
    mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
    for (Eigen::Index k = 0; k < count; ++k) {
      mesh.vertices.col(k) = mesh_.point(used[k]);
      mesh.parameters.col(k) = mesh_.parameter(used[k]);
    }
    for (std::size_t k = 0; k < triangles.size(); ++k) mesh.triangles.col(k) = triangles[k];
    AddNormals(mesh, Ambiguous(numbers, count));
    AddSides(mesh, own);
    mesh.vertices.colwise() += mesh_.middle();
    return {std::move(mesh), std::move(used)};
  }

 private:
  // Which vertices of the mesh stand for places with different normals: tips, creased seams.
  std::vector<char> Ambiguous(const std::vector<int>& numbers, Eigen::Index count) const {
    constexpr double kAlike = 1 - 1e-6;  // the cosine
    std::vector<char> ambiguous(count, 0);
    for (const auto& [key, vertex] : mesh_.border()) {
      const int name = names_[vertex];
      if (name == vertex || numbers[name] < 0) continue;
      const auto first =
          mesh_.surface().NormalAt(mesh_.parameter(name)[0], mesh_.parameter(name)[1]);
      const auto other =
          mesh_.surface().NormalAt(mesh_.parameter(vertex)[0], mesh_.parameter(vertex)[1]);
      if (first && other && first->dot(*other) < kAlike) ambiguous[numbers[name]] = 1;
    }
    return ambiguous;
  }

  // Where the surface has no normal, or several, the mean of the triangles around.
  void AddNormals(TriangleMesh& mesh, const std::vector<char>& ambiguous) const {
    mesh.normals.setZero(3, mesh.vertices.cols());
    for (const auto triangle : mesh.triangles.colwise()) {
      const Eigen::Vector3d a = mesh.vertices.col(triangle[0]);
      const Eigen::Vector3d normal =
          (mesh.vertices.col(triangle[1]) - a)
              .cross(Eigen::Vector3d(mesh.vertices.col(triangle[2]) - a));
      for (const int vertex : triangle) mesh.normals.col(vertex) += normal;
    }
    for (Eigen::Index k = 0; k < mesh.normals.cols(); ++k) {
      const auto normal = mesh_.surface().NormalAt(mesh.parameters(0, k), mesh.parameters(1, k));
      if (normal && !ambiguous[k]) {
        mesh.normals.col(k) = *normal;
      } else {
        mesh.normals.col(k) = mesh.normals.col(k).stableNormalized().eval();
      }
    }
  }

  // Whether the point lies where triangles around it may see it differently.
  bool ManySided(const LatticePoint& point) const {
    const auto on = [](const std::vector<std::int64_t>& lines, std::int64_t at) {
      return std::binary_search(lines.begin(), lines.end(), at);
    };
    return mesh_.domain().OnBorder(point) || on(mesh_.domain().creases_u(), point.x) ||
           on(mesh_.domain().creases_v(), point.y);
  }

  // Notes the corners whose parameters or normals are not those of their vertices.
  void AddSides(TriangleMesh& mesh, const std::vector<std::array<int, 3>>& own) const {
    constexpr double kAlike = 1 - 1e-6;     // the cosine
    constexpr double kInwards = 1e-7;       // of the way to the triangle's middle: on its side
    std::map<int, std::vector<int>> sides;  // of each vertex before it got its name
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
      const std::array<int, 3>& corners = own[static_cast<std::size_t>(t)];
      const Eigen::Vector2d centre = (mesh_.parameter(corners[0]) + mesh_.parameter(corners[1]) +
                                      mesh_.parameter(corners[2])) /
                                     3;
      for (int e = 0; e < 3; ++e) {
        const int corner = corners[e], vertex = mesh.triangles(e, t);
        if (names_[corner] == corner && !ManySided(mesh_.delaunay().points()[corner])) continue;
        const Eigen::Vector2d& parameter = mesh_.parameter(corner);
        const Eigen::Vector2d inside = parameter + kInwards * (centre - parameter);
        const Eigen::Vector3d usual = mesh.normals.col(vertex);
        const Eigen::Vector3d normal =
            mesh_.surface().NormalAt(inside[0], inside[1]).value_or(usual);
        if (parameter == mesh.parameters.col(vertex) && normal.dot(usual) > kAlike) continue;
        std::vector<int>& known = sides[corner];
        const auto same = std::find_if(known.begin(), known.end(), [&](int side) {
          return mesh.other_sides[side].normal.dot(normal) > kAlike;
        });
        int side = static_cast<int>(mesh.other_sides.size());
        if (same != known.end()) {
          side = *same;
        } else {
          known.push_back(side);
          mesh.other_sides.push_back({vertex, parameter, normal});
        }
        mesh.side_corners.push_back({static_cast<int>(t), e, side});
      }
    }
  }

  const DomainMesh& mesh_;
  const std::vector<int>& names_;
};

}  // namespace

ExtractedMesh ExtractMesh(const DomainMesh& mesh, const std::vector<int>& names) {
  return MeshExtraction(mesh, names).Run();
}

}  // namespace batten::internal
