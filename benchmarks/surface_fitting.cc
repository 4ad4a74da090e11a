// SPDX-License-Identifier: MIT
// Prints, as Markdown tables, how near surface fits with nothing given but the points come to bent
// sheets that are known, medians over seeds: rms and largest distance of the noise-free sheet from
// the fitted surface, beside the best that a uniform bicubic reaches at the true parameters of the
// same points (the oracle). `SHEET…` prints only sheets whose names contain one of the words.
#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "ablation.h"
#include "batten/fitting/fit_surface.h"
#include "batten/fitting/statistics.h"
#include "batten/geometry/surface_evaluator.h"
#include "geometry/nurbs/span_breaks.h"
#include "known_sheets.h"

using namespace batten;
using namespace batten::internal;

namespace batten::internal {
namespace {

constexpr int kSeeds = 3;
constexpr int kPlaces = 141;  // of the truth, a direction
constexpr double kSigma = 1e-3;

// Neighbouring places of a fine grid whose normals turn by more than a right angle.
int Folds(const NurbsSurface& surface) {
  constexpr int kPerSpan = 6;
  const std::vector<double> us = BreaksIn(surface.basis_u(), kPerSpan),
                            vs = BreaksIn(surface.basis_v(), kPerSpan);
  SurfaceGrid grid;
  SurfaceEvaluator(surface).Grid(us, vs, grid);
  const auto columns = static_cast<Eigen::Index>(vs.size());
  int folds = 0;
  for (Eigen::Index k = 0; k < grid.normals.cols(); ++k) {
    const auto turned = [&](Eigen::Index other) {
      return grid.normals.col(k).dot(grid.normals.col(other)) < 0;
    };
    if (k % columns > 0 && turned(k - 1)) ++folds;
    if (k >= columns && turned(k - columns)) ++folds;
  }
  return folds;
}

// What was measured of every fit and its oracle.
struct Runs {
  std::vector<double> control_points, rms, max, folds, seconds;
  std::vector<double> oracle_control_points, oracle_rms;
  int failed = 0;
  std::string why;
};

Runs RunSeeds(const KnownSheet& sheet, const SheetCloudKind& kind) {
  Runs runs;
  ThreadPool pool(0);
  const Eigen::Matrix3Xd places = PlacesOf(sheet, kPlaces);
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const SheetCloud cloud = CloudOn(sheet, kind, static_cast<std::uint64_t>(seed));
    const BestUniform oracle = UniformOracle(cloud, places, pool).Best();
    runs.oracle_control_points.push_back(oracle.size_u * oracle.size_v);
    runs.oracle_rms.push_back(oracle.error.rms);
    try {
      const SurfaceFit fit = FitSurface(PointCloud::FromWorld(cloud.points));
      const SheetError error = ErrorAt(places, fit.surface, pool);
      runs.control_points.push_back(fit.surface.size_u() * fit.surface.size_v());
      runs.rms.push_back(error.rms);
      runs.max.push_back(error.max);
      runs.folds.push_back(Folds(fit.surface));
      runs.seconds.push_back(fit.report.seconds.total);
    } catch (const std::exception& failure) {
      ++runs.failed;
      runs.why = failure.what();
    }
  }
  return runs;
}

void PrintRow(const std::string& name, const KnownSheet& sheet, const SheetCloudKind& kind) {
  const Runs runs = RunSeeds(sheet, kind);
  std::printf("| %s | %td | ", name.c_str(), kind.count);
  if (runs.rms.empty()) {
    std::printf("– | %.0f | – | %.2e | – | – | – |\n",
                Median(runs.oracle_control_points),
                Median(runs.oracle_rms));
  } else {
    std::printf("%.0f | %.0f | %.2e | %.2e | %.2e | %.0f | %.2f |\n",
                Median(runs.control_points),
                Median(runs.oracle_control_points),
                Median(runs.rms),
                Median(runs.oracle_rms),
                Median(runs.max),
                Median(runs.folds),
                Median(runs.seconds));
  }
  if (runs.failed > 0) {
    std::printf("(%d of %d seeds failed: %s)\n", runs.failed, kSeeds, runs.why.c_str());
  }
  std::fflush(stdout);
}

// Largest extent of the sheet's box: noise is told in thousandths of it.
double SizeOf(const KnownSheet& sheet) {
  const Eigen::Matrix3Xd places = PlacesOf(sheet, kPlaces);
  return (places.rowwise().maxCoeff() - places.rowwise().minCoeff()).maxCoeff();
}

bool Chosen(const std::string& name, std::span<const std::string> words) {
  if (words.empty()) return true;
  for (const std::string& word : words) {
    if (name.find(word) != std::string::npos) return true;
  }
  return false;
}

void PrintSheets(std::span<const std::string> words) {
  std::printf(
      "| sheet | points | control points | oracle's | truth rms | oracle's | truth max | folds | "
      "seconds |\n|---|---|---|---|---|---|---|---|---|\n");
  const auto row = [&](const KnownSheet& sheet, SheetCloudKind kind, const std::string& suffix) {
    const std::string name = sheet.name + suffix;
    if (Chosen(name, words)) PrintRow(name, sheet, kind);
  };
  const KnownSheet shell = WavyShell();
  row(shell, {20000, kSigma}, "");
  row(shell, {100000, kSigma}, "");
  row(shell, {20000, kSigma, 0.01}, ", 1 % outliers");
  row(shell, {20000, kSigma, 0.2}, ", 20 % outliers");
  const double spacing = std::sqrt(shell.sides.prod() / 20000);
  row(shell, {20000, spacing}, ", σ = the points' spacing");
  constexpr double kGap = 0.048;  // 4.1 spacings of 30 000 points
  for (const KnownSheet& sheet : {DoubleBend(),
                                  Roll(kGap),
                                  GradedSheet(10),
                                  SphericalCap(60),
                                  SphericalCap(120),
                                  WideningPipe()}) {
    row(sheet, {30000, kSigma * SizeOf(sheet)}, "");
  }
}

}  // namespace
}  // namespace batten::internal

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    PrintSheets(words);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "surface_fitting: %s\n", error.what());
    return 1;
  }
  return 0;
}
