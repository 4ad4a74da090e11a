// SPDX-License-Identifier: MIT
// Prints, as a Markdown table, how near surface fits with nothing given but the points come to
// closed shapes that are known, medians over three seeds and poses: rms distance of the noise-free
// shape from the fitted surface, beside what noise alone leaves of as many numbers, σ √(n/N), and
// beside the best that a uniform bicubic net reaches at the true parameters (the oracle). Noise is
// a thousandth of the size. `SHAPE…` prints only shapes whose names contain one of the words.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "ablation.h"
#include "batten/fitting/fit_surface.h"
#include "batten/fitting/statistics.h"
#include "closed_oracle.h"

using namespace batten;
using namespace batten::internal;

namespace batten::internal {
namespace {

constexpr int kSeeds = 3;
constexpr Eigen::Index kPlaces = 10000;  // of the truth
constexpr double kNoiseOfSize = 1e-3;

Eigen::Matrix3d TurnOf(std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond q(normal(engine), normal(engine), normal(engine), normal(engine));
  return q.normalized().toRotationMatrix();
}

std::string WordsOf(const SurfaceFit& fit) {
  const GeometrySummary& geometry = fit.report.geometry;
  std::string words = geometry.base;
  if (geometry.closed[0] || geometry.closed[1]) {
    words += ", closed in ";
    if (geometry.closed[0]) words += "u";
    if (geometry.closed[1]) words += geometry.closed[0] ? " and v" : "v";
  }
  const int poles = int{geometry.poles[0]} + int{geometry.poles[1]};
  if (poles > 0) words += poles == 1 ? ", a pole" : ", two poles";
  return words;
}

void PrintRow(const TurnedShape& shape, Eigen::Index count, double outliers) {
  std::vector<double> numbers, oracle_numbers, rms, limit, oracle_rms, jump, seconds;
  std::string words;
  const double sigma = kNoiseOfSize * shape.Size();
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Eigen::Matrix3d turn = TurnOf(seed);
    const TurnedPoints cloud = PointsOn(shape, count, sigma, seed);
    const TurnedPoints truth = TruthOn(shape, kPlaces, shape.SpacingOf(count));
    const auto strays = static_cast<Eigen::Index>(outliers * static_cast<double>(count));
    const Eigen::Matrix3Xd points = turn * WithOutliersInBox(cloud.points, strays, seed + 100);
    try {
      const SurfaceFit fit = FitSurface(PointCloud::FromWorld(points));
      const NurbsSurface& s = fit.surface;
      const NurbsSurface back(
          s.basis_u(), s.basis_v(), turn.transpose() * s.control_points(), s.weights());
      const int n = FreePointsOf(s);
      numbers.push_back(n);
      rms.push_back(ErrorOfShape(back, truth.points).rms);
      limit.push_back(sigma * std::sqrt(n / static_cast<double>(count)));
      const SeamJump none;
      const SeamJump u = s.basis_u().periodic() ? JumpAcross(s, true) : none,
                     v = s.basis_v().periodic() ? JumpAcross(s, false) : none;
      jump.push_back(std::max({u.position, v.position, u.normal, v.normal}));
      seconds.push_back(fit.report.seconds.total);
      words = WordsOf(fit);
    } catch (const std::exception& failure) {
      words = std::string("refused: ") + failure.what();
      continue;
    }
    const ClosedOracle oracle = BestUniform(shape, cloud, truth);
    oracle_numbers.push_back(oracle.unknowns);
    oracle_rms.push_back(oracle.rms);
  }
  std::printf("| %s%s | %td | %s | ",
              shape.name.c_str(),
              outliers > 0 ? ", 10 % outliers" : "",
              count,
              words.c_str());
  if (rms.empty()) {
    std::printf("– | – | – | – | – |\n");
  } else {
    std::printf("%.0f (%.0f) | %.2e (%.2e) | %.2e | %.0e | %.2f |\n",
                Median(numbers),
                Median(oracle_numbers),
                Median(rms),
                Median(oracle_rms),
                Median(limit),
                Median(jump),
                Median(seconds));
  }
  std::fflush(stdout);
}

bool Chosen(const std::string& name, std::span<const std::string> words) {
  for (const std::string& word : words) {
    if (name.find(word) != std::string::npos) return true;
  }
  return words.empty();
}

void PrintTable(std::span<const std::string> words) {
  std::printf(
      "| shape | points | base | control points (oracle's) | truth rms (oracle's) | limit | seam | "
      "seconds |\n|---|---|---|---|---|---|---|---|\n");
  const TurnedShape whole[] = {CylinderShapeOf(),
                               SteepCone(),
                               RippledVase(),
                               TorusShapeOf(),
                               WholeSphere(),
                               Egg(),
                               Cup(),
                               OvalRing()};
  for (const TurnedShape& shape : whole) {
    if (!Chosen(shape.name, words)) continue;
    PrintRow(shape, 20000, 0);
    PrintRow(shape, 20000, 0.1);
  }
  for (const TurnedShape& shape : whole) {
    const TurnedShape piece = PieceOf(shape);
    if (Chosen(piece.name, words)) PrintRow(piece, 20000, 0);
  }
  for (const double degrees : {90.0, 200.0}) {
    const TurnedShape elbow = PipeElbow(degrees);
    if (Chosen(elbow.name, words)) PrintRow(elbow, 20000, 0);
  }
}

}  // namespace
}  // namespace batten::internal

int main(int argc, char** argv) {
  try {
    PrintTable(std::vector<std::string>(argv + 1, argv + argc));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
