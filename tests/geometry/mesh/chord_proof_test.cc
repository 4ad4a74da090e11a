// SPDX-License-Identifier: MIT
#include "batten/geometry/chord_proof.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "batten/geometry/bounding_box.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "trim_cases.h"

namespace batten::internal::chord_proof_test {

constexpr double kAbove = 1 + 1e-6;  // planes of rounded vertices

TriangleMesh MeshOf(const NurbsSurface& surface, double tolerance) {
  TessellateOptions options;
  options.chord_tolerance = tolerance;
  return Tessellate(surface, options);
}

TEST(ChordProofTest, MeshesAreProvedWithinTheirTolerance) {
  RandomSplines random(6);
  const NurbsSurface sheet = random.Sheet(3, 2, 1);
  const NurbsSurface trimmed = Trimmed(sheet, {Ellipse({0.5, 0.5}, {0.3, 0.2})});
  for (const NurbsSurface& surface : {sheet, trimmed, Cylinder(3, 5), Sphere(2), Torus(3, 1)}) {
    const double tolerance = 1e-3 * BoundingBox(surface).diagonal().norm();
    const TriangleMesh mesh = MeshOf(surface, tolerance);
    EXPECT_TRUE(UnprovedTriangles(surface, mesh, kAbove * tolerance).empty());
    const NurbsSurface far = surface.Translated({5e5, 5e6, 100});
    EXPECT_TRUE(UnprovedTriangles(far, MeshOf(far, tolerance), kAbove * tolerance).empty());
  }
}

// No triangle is proved over which the surface is measured farther from the plane.
TEST(ChordProofTest, WhatIsFartherIsListed) {
  const NurbsSurface surface = Torus(3, 1);
  TriangleMesh mesh = MeshOf(surface, 0.02);
  const double tolerance = 0.004;
  const std::vector<int> unproved = UnprovedTriangles(surface, mesh, tolerance);
  ASSERT_FALSE(unproved.empty());
  ASSERT_TRUE(mesh.side_corners.size() > 0);
  std::vector<bool> touched(static_cast<size_t>(mesh.triangles.cols()), false);
  for (const SideCorner& corner : mesh.side_corners) touched[corner.triangle] = true;
  Eigen::Index farther = 0;
  for (int k = 0; k < mesh.triangles.cols(); ++k) {
    if (touched[k]) continue;
    const auto t = mesh.triangles.col(k);
    const Eigen::Vector2d uv =
        (mesh.parameters.col(t[0]) + mesh.parameters.col(t[1]) + mesh.parameters.col(t[2])) / 3;
    const Eigen::Vector3d a = mesh.vertices.col(t[0]);
    const Eigen::Vector3d normal =
        (mesh.vertices.col(t[1]) - a).cross(mesh.vertices.col(t[2]) - a).normalized();
    if (std::abs(normal.dot(surface.At(uv[0], uv[1]) - a)) <= tolerance) continue;
    ++farther;
    EXPECT_TRUE(std::binary_search(unproved.begin(), unproved.end(), k)) << k;
  }
  EXPECT_GT(farther, 0);
}

TEST(ChordProofTest, AMovedVertexIsFound) {
  const NurbsSurface surface = Cylinder(3, 5);
  TriangleMesh mesh = MeshOf(surface, 0.01);
  ASSERT_TRUE(UnprovedTriangles(surface, mesh, kAbove * 0.01).empty());
  const int vertex = mesh.triangles(0, mesh.triangles.cols() / 2);
  mesh.vertices.col(vertex) += 0.03 * mesh.normals.col(vertex);
  EXPECT_FALSE(UnprovedTriangles(surface, mesh, kAbove * 0.01).empty());
  EXPECT_THROW(UnprovedTriangles(surface, mesh, 0), std::invalid_argument);
}

}  // namespace batten::internal::chord_proof_test
