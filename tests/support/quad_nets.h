// SPDX-License-Identifier: MIT
// Closed meshes of quadrilaterals for tests.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "batten/geometry/quad_mesh.h"
#include "geometry/subdivision/catmull_clark.h"

namespace batten::internal {

// The cube of side 2 about the origin: eight vertices of three edges.
inline QuadMesh Cube() {
  QuadMesh cube;
  cube.vertices.resize(3, 8);
  for (int k = 0; k < 8; ++k) {
    cube.vertices.col(k) << (k & 1 ? 1 : -1), (k & 2 ? 1 : -1), (k & 4 ? 1 : -1);
  }
  cube.faces.resize(4, 6);
  cube.faces.col(0) << 0, 2, 3, 1;
  cube.faces.col(1) << 4, 5, 7, 6;
  cube.faces.col(2) << 0, 1, 5, 4;
  cube.faces.col(3) << 2, 6, 7, 3;
  cube.faces.col(4) << 0, 4, 6, 2;
  cube.faces.col(5) << 1, 3, 7, 5;
  return cube;
}

// A torus about z of n × m faces: every vertex has four edges.
inline QuadMesh Torus(int n, int m, double radius = 2, double tube = 1) {
  QuadMesh torus;
  torus.vertices.resize(3, n * m);
  torus.faces.resize(4, n * m);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / m;
      const double r = radius + tube * std::cos(b);
      torus.vertices.col(i * m + j) << r * std::cos(a), r * std::sin(a), tube * std::sin(b);
      const int i1 = (i + 1) % n, j1 = (j + 1) % m;
      torus.faces.col(i * m + j) << i * m + j, i1 * m + j, i1 * m + j1, i * m + j1;
    }
  }
  return torus;
}

// A prism of 2n sides: top and bottom are n quadrilaterals about a vertex of n edges; the vertices
// on their rims have three and four.
inline QuadMesh Prism(int n) {
  QuadMesh prism;
  prism.vertices.resize(3, 4 * n + 2);
  prism.faces.resize(4, 4 * n);
  for (int k = 0; k < 2 * n; ++k) {
    const double angle = std::numbers::pi * k / n;
    prism.vertices.col(k) << std::cos(angle), std::sin(angle), 1;
    prism.vertices.col(2 * n + k) << std::cos(angle), std::sin(angle), -1;
  }
  prism.vertices.col(4 * n) << 0, 0, 1;
  prism.vertices.col(4 * n + 1) << 0, 0, -1;
  for (int k = 0; k < n; ++k) {
    const int a = 2 * k, b = (2 * k + 1) % (2 * n), c = (2 * k + 2) % (2 * n);
    prism.faces.col(k) << 4 * n, a, b, c;
    prism.faces.col(n + k) << 4 * n + 1, 2 * n + c, 2 * n + b, 2 * n + a;
    prism.faces.col(2 * n + 2 * k) << 2 * n + a, 2 * n + b, b, a;
    prism.faces.col(2 * n + 2 * k + 1) << 2 * n + b, 2 * n + c, c, b;
  }
  return prism;
}

inline QuadMesh Refined(const QuadMesh& mesh) {
  const SubdividedMesh finer =
      Subdivided(QuadTopology(mesh.faces, static_cast<int>(mesh.vertices.cols())));
  return {Combined(finer.stencils, mesh.vertices), finer.topology.corners()};
}

inline QuadMesh Shaken(QuadMesh mesh, double by, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> shift(-by, by);
  for (double& value : mesh.vertices.reshaped()) value += shift(random);
  return mesh;
}

}  // namespace batten::internal
