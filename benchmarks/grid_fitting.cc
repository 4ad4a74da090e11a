// SPDX-License-Identifier: MIT
// Franke's function on a regular grid: interpolation or, with a tolerance, approximation within it.
// Prints median seconds, control points and errors as peers/sisl_grids.c does for SISL: the rms of
// z against the function, and the largest difference from the interpolant. THREADS 0: all cores.
// Usage: grid_fitting LINES THREADS [TOLERANCE]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "batten/fitting/approximate_grid.h"
#include "batten/fitting/interpolate_grid.h"
#include "batten/geometry/surface_evaluator.h"
#include "job_results.h"
#include "known_grids.h"

using namespace batten;
using namespace batten::internal;

namespace batten::internal {
namespace {

constexpr int kFiner = 4, kMostPlaces = 2000;

struct Errors {
  double rms = 0;   // of z to the function, at the surface's own (x, y)
  double most = 0;  // distance from another surface at the same parameters
};

Errors Measure(const NurbsSurface& surface, const NurbsSurface& other, int lines) {
  const int fine = std::min(kFiner * (lines - 1), kMostPlaces);
  std::vector<double> places;
  for (int k = 0; k <= fine; ++k) places.push_back(static_cast<double>(k) / fine);
  SurfaceGrid a, b;
  SurfaceEvaluator(surface).Grid(places, places, a);
  SurfaceEvaluator(other).Grid(places, places, b);
  Errors errors;
  for (Eigen::Index k = 0; k < a.points.cols(); ++k) {
    const Eigen::Vector3d p = a.points.col(k);
    errors.rms += std::pow(p[2] - Franke(p[0], p[1]), 2);
    errors.most = std::max(errors.most, (p - b.points.col(k)).norm());
  }
  errors.rms = std::sqrt(errors.rms / static_cast<double>(a.points.cols()));
  return errors;
}

void Run(int lines, double tolerance, ThreadPool& pool) {
  const PointNet net = FrankeGrid(lines, lines);
  const NurbsSurface through = InterpolateGrid(net, {}, pool).surface;
  JobRuns runs;
  const NurbsSurface surface = RunJob(runs, [&] {
    return tolerance > 0 ? ApproximateGrid(net, tolerance, {}, pool).surface
                         : InterpolateGrid(net, {}, pool).surface;
  });
  const Errors errors = Measure(surface, through, lines);
  runs.PrintSeconds();
  std::printf(" numbers=%d rms=%.4e", surface.size_u() * surface.size_v(), errors.rms);
  if (tolerance > 0) std::printf(" max=%.4e", errors.most);
  std::printf("\n");
}

}  // namespace
}  // namespace batten::internal

int main(int argc, char** argv) {
  const int lines = argc > 2 ? std::atoi(argv[1]) : 0;
  if (lines < 4 || argc > 4) {
    std::fprintf(stderr, "usage: grid_fitting LINES THREADS [TOLERANCE]\n");
    return 2;
  }
  ThreadPool pool(std::atoi(argv[2]));
  Run(lines, argc > 3 ? std::atof(argv[3]) : 0, pool);
  return 0;
}
