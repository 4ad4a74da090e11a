// SPDX-License-Identifier: MIT
// Closed meshes of quadrilaterals for tests.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

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
  const SubdividedMesh finer = Subdivided(QuadTopology(mesh));
  const QuadTopology& topology = finer.topology;
  QuadMesh refined{Combined(finer.stencils, mesh.vertices), topology.corners()};
  refined.corners = mesh.corners;
  for (int h = 0; h < topology.half_edges(); ++h) {
    if (!topology.IsCrease(h) || topology.Twin(h) < h) continue;
    refined.creases.conservativeResize(2, refined.creases.cols() + 1);
    refined.creases.rightCols(1) << topology.Origin(h), topology.Origin(QuadTopology::Next(h));
  }
  return refined;
}

// With creases where faces meet at more than an angle, and corners where their curves turn by more.
inline QuadMesh Creased(QuadMesh mesh, double angle) {
  const QuadTopology topology(mesh);
  const auto normal = [&](int face) -> Eigen::Vector3d {
    const auto corner = mesh.faces.col(face);
    const Eigen::Vector3d one = mesh.vertices.col(corner[2]) - mesh.vertices.col(corner[0]);
    return one.cross(mesh.vertices.col(corner[3]) - mesh.vertices.col(corner[1])).normalized();
  };
  std::vector<std::vector<int>> beside(std::size_t(mesh.vertices.cols()));
  for (int h = 0; h < topology.half_edges(); ++h) {
    const int twin = topology.Twin(h);
    if (normal(h >> 2).dot(normal(twin >> 2)) > std::cos(angle)) continue;
    beside[std::size_t(topology.Origin(h))].push_back(topology.Origin(QuadTopology::Next(h)));
    if (twin < h) continue;
    mesh.creases.conservativeResize(2, mesh.creases.cols() + 1);
    mesh.creases.rightCols(1) << topology.Origin(h), topology.Origin(QuadTopology::Next(h));
  }
  for (int v = 0; v < topology.vertices(); ++v) {
    const std::vector<int>& ends = beside[std::size_t(v)];
    if (ends.size() != 2) continue;
    const Eigen::Vector3d one = mesh.vertices.col(ends[0]) - mesh.vertices.col(v);
    const Eigen::Vector3d two = mesh.vertices.col(v) - mesh.vertices.col(ends[1]);
    if (one.normalized().dot(two.normalized()) < std::cos(angle)) mesh.corners.push_back(v);
  }
  return mesh;
}

// The L of three cubes of side 1, one unit thick, of 14 unit squares.
inline QuadMesh LBlock() {
  // Corners of the outline on the grid, with its inner vertex; bottom then top.
  const std::array<std::array<int, 2>, 8> at = {
      {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}}};
  QuadMesh block;
  block.vertices.resize(3, 16);
  for (int k = 0; k < 16; ++k) block.vertices.col(k) << at[k % 8][0], at[k % 8][1], k / 8;
  block.faces.resize(4, 14);
  const std::array<std::array<int, 4>, 3> squares = {{{0, 1, 4, 7}, {1, 2, 3, 4}, {7, 4, 5, 6}}};
  for (int k = 0; k < 3; ++k) {
    const auto& q = squares[k];
    block.faces.col(k) << q[0], q[3], q[2], q[1];
    block.faces.col(3 + k) << q[0] + 8, q[1] + 8, q[2] + 8, q[3] + 8;
  }
  for (int k = 0; k < 8; ++k) {
    const int next = (k + 1) % 8;
    block.faces.col(6 + k) << k, next, next + 8, k + 8;
  }
  return block;
}

inline QuadMesh Shaken(QuadMesh mesh, double by, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> shift(-by, by);
  for (double& value : mesh.vertices.reshaped()) value += shift(random);
  return mesh;
}

// A round can about z of radius and height 1, its caps 2 × 2 squares within a ring of eight faces;
// `sides` rings of eight between. The rims are creases.
inline QuadMesh Can(int sides = 1) {
  const auto rim = [](int k) -> Eigen::Vector2d {
    const double angle = std::numbers::pi / 4 * (k - 3);
    return {std::cos(angle), std::sin(angle)};
  };
  // Of the inner squares, counter-clockwise as the rim, and their middle.
  const std::array<std::array<int, 2>, 9> inner = {
      {{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {0, 0}}};
  QuadMesh can;
  const int top = 8 * (sides + 1), bottom = top + 9;
  can.vertices.resize(3, bottom + 9);
  can.faces.resize(4, 24 + 8 * sides);
  for (int ring = 0; ring <= sides; ++ring) {
    for (int k = 0; k < 8; ++k) can.vertices.col(8 * ring + k) << rim(k), double(ring) / sides;
  }
  for (int k = 0; k < 9; ++k) {
    const double x = 0.4 * inner[k][0], y = 0.4 * inner[k][1];
    can.vertices.col(top + k) << x, y, 1;
    can.vertices.col(bottom + k) << x, y, 0;
  }
  int face = 0;
  for (int k = 0; k < 8; ++k) {
    const int next = (k + 1) % 8;
    for (int ring = 0; ring < sides; ++ring) {
      const int low = 8 * ring;
      can.faces.col(face++) << low + k, low + next, low + 8 + next, low + 8 + k;
    }
    can.faces.col(face++) << 8 * sides + k, 8 * sides + next, top + next, top + k;
    can.faces.col(face++) << k, bottom + k, bottom + next, next;
  }
  for (int k = 0; k < 8; k += 2) {
    const int before = (k + 7) % 8;
    can.faces.col(face++) << top + before, top + k, top + k + 1, top + 8;
    can.faces.col(face++) << bottom + before, bottom + 8, bottom + k + 1, bottom + k;
  }
  return Creased(can, 1);
}

// A torus on which creases meet, end and pass: three along one direction and two across.
inline QuadMesh CreasedTorus() {
  QuadMesh torus = Torus(8, 7);
  torus.creases.resize(2, 5);
  torus.creases << 7, 14, 21, 15, 16, 14, 21, 28, 16, 17;
  torus.creases.col(3) << 14, 15;
  torus.creases.col(4) << 15, 16;
  return torus;
}

}  // namespace batten::internal
