// SPDX-License-Identifier: MIT
// Points and surfaces of whole bodies.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "batten/geometry/triangle_surface.h"
#include "quad_nets.h"

namespace batten::internal {

// Points on the sphere of radius 1 about the origin, moved by noise along the normal.
inline Eigen::Matrix3Xd SpherePoints(int count, double noise, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::Matrix3Xd points(3, count);
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d way(normal(random), normal(random), normal(random));
    points.col(k) = (1 + noise * normal(random)) * way.normalized();
  }
  return points;
}

// The cube refined so often, its vertices on the sphere of radius 1.
inline QuadMesh CubeSphere(int refinements) {
  QuadMesh mesh = Cube();
  for (int k = 0; k < refinements; ++k) mesh = Refined(mesh);
  mesh.vertices.colwise().normalize();
  return mesh;
}

// Faces of a mesh of quadrilaterals, each as a list.
inline std::vector<std::vector<int>> FacesOf(const QuadMesh& mesh) {
  std::vector<std::vector<int>> faces;
  for (const auto face : mesh.faces.colwise()) faces.emplace_back(face.begin(), face.end());
  return faces;
}

}  // namespace batten::internal
