// SPDX-License-Identifier: MIT
// A scan against its nominal CAD model: deviations, and a mesh coloured by them.
//   compare_nominal OUT.ply
#include <batten/batten.h>

#include <filesystem>
#include <iostream>
#include <variant>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  // In place of the files of a real part: the nominal cylinder as STEP, and a scan of one that was
  // made 0.05 mm too thick.
  const std::string nominal = std::filesystem::path(argv[1]).replace_extension(".step");
  batten::WriteGeometry({batten::MakeCylinder({}, 20, {0, 50})}, nominal);
  const batten::PointCloud scan = batten::SampleGeometry(batten::MakeCylinder({}, 20.05, {1, 49}),
                                                         {.count = 20000, .noise = 0.01});

  const auto model = batten::ReadGeometry(nominal);
  const auto& surface = std::get<batten::NurbsSurface>(model.front());
  batten::ThreadPool pool(0);
  const batten::PointDistances found =
      batten::DistancesTo(surface.Translated(-scan.origin()), scan.points(), pool);
  const batten::ErrorSummary error = batten::Summarise(found.distances, 0.1);
  std::cout << "mean " << error.mean << ", 95 % within " << error.p95 << ", farthest " << error.max
            << ", out of 0.1 mm: " << error.out_of_tolerance << " of " << error.points << '\n';

  // Two-way: what the scan says at the vertices of the model.
  batten::SurfaceMesh mesh{batten::Tessellate(surface), "nominal"};
  const batten::SurfaceFit measured = batten::FitSurface(scan, {.tolerance = 0.05});
  mesh.deviations = -batten::DistancesTo(measured.surface, mesh.mesh.vertices, pool).distances;
  batten::WriteMeshes({mesh}, argv[1]);
  return std::abs(error.mean - 0.05) < 0.005 ? 0 : 1;
}
