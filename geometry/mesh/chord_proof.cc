// SPDX-License-Identifier: MIT
#include "batten/geometry/chord_proof.h"

#include <Eigen/Geometry>
#include <array>
#include <stdexcept>

#include "geometry/mesh/triangle_proof.h"
#include "geometry/numeric/constants.h"

namespace batten {

std::vector<int> UnprovedTriangles(const NurbsSurface& surface,
                                   const TriangleMesh& mesh,
                                   double tolerance) {
  if (!(tolerance > 0))
    throw std::invalid_argument("UnprovedTriangles: tolerance: must be positive");
  std::vector<std::array<Eigen::Vector2d, 3>> corners;
  for (const auto triangle : mesh.triangles.colwise()) {
    corners.push_back({mesh.parameters.col(triangle[0]),
                       mesh.parameters.col(triangle[1]),
                       mesh.parameters.col(triangle[2])});
  }
  for (const SideCorner& other : mesh.side_corners)
    corners[other.triangle][other.corner] = mesh.other_sides[other.side].parameter;
  constexpr double kRoundings = 64;  // of plane and hulls, on coordinates
  const double rounding =
      kRoundings * internal::kEpsilon * surface.control_points().cwiseAbs().maxCoeff();
  internal::TriangleProof proof(surface);
  std::vector<int> unproved;
  for (Eigen::Index k = 0; k < mesh.triangles.cols(); ++k) {
    const Eigen::Vector3d a = mesh.vertices.col(mesh.triangles(0, k));
    const Eigen::Vector3d normal = (mesh.vertices.col(mesh.triangles(1, k)) - a)
                                       .cross(mesh.vertices.col(mesh.triangles(2, k)) - a)
                                       .normalized();
    if (normal.isZero(0) || proof.OffPlane(corners[k], normal, normal.dot(a), tolerance - rounding))
      unproved.push_back(static_cast<int>(k));
  }
  return unproved;
}

}  // namespace batten
