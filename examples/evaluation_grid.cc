// SPDX-License-Identifier: MIT
// A surface evaluated on a grid of parameters, and that grid as a mesh.
//   evaluation_grid GEOMETRY OUT.ply
#include <batten/batten.h>

#include <iostream>
#include <variant>
#include <vector>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  constexpr int kSide = 50;
  const auto geometry = batten::ReadGeometry(argv[1]);
  const auto& surface = std::get<batten::NurbsSurface>(geometry.front());
  const auto steps = [](const batten::SplineBasis& basis) {
    std::vector<double> values;
    for (int k = 0; k < kSide; ++k)
      values.push_back(std::lerp(basis.lower(), basis.upper(), k / (kSide - 1.0)));
    return values;
  };
  const std::vector<double> us = steps(surface.basis_u()), vs = steps(surface.basis_v());
  batten::SurfaceGrid grid;
  batten::SurfaceEvaluator(surface).Grid(us, vs, grid);

  batten::TriangleMesh mesh;
  mesh.vertices = grid.points;
  mesh.normals = grid.normals;
  mesh.parameters.resize(2, kSide * kSide);
  mesh.triangles.resize(3, 2 * (kSide - 1) * (kSide - 1));
  int next = 0;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const int at = i * kSide + j;
      mesh.parameters.col(at) << us[i], vs[j];
      if (i + 1 == kSide || j + 1 == kSide) continue;
      mesh.triangles.col(next++) << at, at + kSide, at + kSide + 1;
      mesh.triangles.col(next++) << at, at + kSide + 1, at + 1;
    }
  }
  batten::WriteMesh(mesh, argv[2]);
  // Tessellate(surface) follows the trims and keeps a chord tolerance; a grid does neither.
  std::cout << mesh.triangles.cols() << " triangles on a grid, "
            << batten::Tessellate(surface).triangles.cols() << " by tolerance\n";
  return 0;
}
