// SPDX-License-Identifier: MIT
// Franke's function on regular grids: interpolation, and approximation within a tolerance. Prints
// seconds, control points and errors as peers/sisl_grids.c does for SISL.
// Usage: grid_fitting [LINES]...
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

#include "batten/fitting/approximate_grid.h"
#include "batten/fitting/interpolate_grid.h"
#include "batten/fitting/stopwatch.h"
#include "batten/geometry/surface_evaluator.h"
#include "known_grids.h"

namespace batten {
namespace {

constexpr int kRepeats = 5, kFiner = 4, kMostPlaces = 2000;

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

void Run(int lines, ThreadPool& pool) {
  const PointNet net = FrankeGrid(lines, lines);
  double best = std::numeric_limits<double>::infinity();
  Stopwatch watch;
  for (int k = 0; k < kRepeats; ++k) {
    watch.Lap();
    InterpolateGrid(net, {}, pool);
    best = std::min(best, watch.Lap());
  }
  const NurbsSurface through = InterpolateGrid(net, {}, pool).surface;
  std::printf("interpolate %d, %d threads: %.3g s, rms to truth %.3g\n",
              lines,
              pool.threads(),
              best,
              Measure(through, through, lines).rms);
  for (const double tolerance : {1e-3, 1e-4}) {
    watch.Lap();
    const ToleratedGrid kept = ApproximateGrid(net, tolerance, {}, pool);
    const double seconds = watch.Lap();
    const Errors errors = Measure(kept.surface, through, lines);
    std::printf(
        "approximate %d %g, %d threads: %.3g s, %d x %d = %d control points, rms to truth %.3g, "
        "max to interpolant %.3g, proven %.3g%s\n",
        lines,
        tolerance,
        pool.threads(),
        seconds,
        kept.surface.size_u(),
        kept.surface.size_v(),
        kept.surface.size_u() * kept.surface.size_v(),
        errors.rms,
        errors.most,
        kept.error,
        kept.interpolates ? " (the interpolant)" : "");
  }
}

}  // namespace
}  // namespace batten

int main(int argc, char** argv) {
  std::vector<int> sizes{21, 51, 100, 200, 1000};
  if (argc > 1) sizes.clear();
  for (int k = 1; k < argc; ++k) sizes.push_back(std::max(4, std::atoi(argv[k])));
  for (const int threads : {1, 2}) {
    batten::ThreadPool pool(threads);
    for (const int lines : sizes) batten::Run(lines, pool);
  }
}
