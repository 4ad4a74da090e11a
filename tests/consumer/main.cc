// SPDX-License-Identifier: MIT
// The README's library sample, as a stranger compiles it.
#include <batten/fitting/fit_surface.h>
#include <batten/io/geometry_file.h>
#include <batten/io/read_cloud.h>

#include <iostream>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const batten::CloudFile file = batten::ReadCloud({argv[1]});
  const batten::SurfaceFit fit = batten::FitSurface(file.cloud, {.tolerance = 0.05});
  if (!fit.report.tolerance_reached().value_or(true)) std::cerr << fit.report.OneLine() << '\n';
  batten::WriteGeometry({fit.surface}, argv[2]);
  std::cout << fit.report.OneLine() << '\n';
  return 0;
}
