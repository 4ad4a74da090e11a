// SPDX-License-Identifier: MIT
// A shell of 200 degrees with bumps, and points of it whose parameters scatter.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

inline Eigen::Vector3d Shell(double u, double v) {
  using std::numbers::pi;
  const double angle = (-100 + 200 * u) * pi / 180;
  const double radius = 1 + 0.08 * std::sin(3 * pi * u) * std::cos(2 * pi * v);
  return {radius * std::sin(angle), 2 * v + 0.1 * std::sin(2 * pi * u), radius * std::cos(angle)};
}

struct ShellKind {
  Eigen::Index points = 4500;
  int net = 14;         // control points a direction, bicubic
  double sigma = 1e-3;  // of every coordinate
  double jitter = 0.5;  // half the width of the parameters' uniform scatter, in cells
  unsigned seed = 0;
};

// Parameters are angle and height of the points, and the scatter.
inline FittingProblem JitteredShell(const ShellKind& kind) {
  std::mt19937_64 engine(kind.seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, kind.sigma);
  auto data = std::make_shared<FittingData>();
  data->values.resize(3, kind.points);
  data->parameters.resize(2, kind.points);
  for (Eigen::Index k = 0; k < kind.points; ++k) {
    const double u = uniform(engine), v = uniform(engine);
    auto point = data->values.col(k);
    point = Shell(u, v);
    for (double& x : point) x += normal(engine);
    data->parameters.col(k) << std::atan2(point[0], point[2]), point[1];
  }
  const Eigen::Vector2d low = data->parameters.rowwise().minCoeff();
  const Eigen::Vector2d high = data->parameters.rowwise().maxCoeff();
  const Eigen::Vector2d cell = (high - low) / (kind.net - 3);
  for (auto uv : data->parameters.colwise()) {
    for (int d = 0; d < 2; ++d) {
      uv[d] =
          std::clamp(uv[d] + kind.jitter * cell[d] * (2 * uniform(engine) - 1), low[d], high[d]);
    }
  }
  return FittingProblem(SplineBasis::Uniform(3, kind.net, low[0], high[0]),
                        SplineBasis::Uniform(3, kind.net, low[1], high[1]),
                        std::move(data),
                        1e-4);
}

// Root mean square of the distances of noise-free points of the shell from a surface.
inline double ShellTruthRms(const NurbsSurface& surface, ThreadPool& pool) {
  constexpr int kSide = 60;
  Eigen::Matrix3Xd truth(3, kSide * kSide);
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j)
      truth.col(i * kSide + j) = Shell((i + 0.5) / kSide, (j + 0.5) / kSide);
  }
  return std::sqrt(DistancesTo(surface, truth, pool).distances.squaredNorm() / (kSide * kSide));
}

}  // namespace batten::internal
