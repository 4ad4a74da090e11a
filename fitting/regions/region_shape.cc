// SPDX-License-Identifier: MIT
#include "fitting/regions/region_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "batten/fitting/robust_loss.h"
#include "fitting/core/shared_constants.h"
#include "fitting/primitives/surface_minimum.h"
#include "fitting/primitives/surface_starts.h"

namespace batten::internal {
namespace {

constexpr std::size_t kFitPoints = 600, kJudges = 80;

StartData StartsOf(const RegionPoints& data, const std::vector<int>& members) {
  StartData start;
  const std::vector<int> some = Thinned(members, kFitPoints), few = Thinned(some, kJudges);
  const auto part = [&](const std::vector<int>& of) {
    ShapeData shape;
    shape.points = data.points(Eigen::all, of);
    shape.weights = Eigen::VectorXd::Ones(shape.points.cols());
    return shape;
  };
  start.sample = part(some);
  start.judges = part(few);
  start.oriented.push_back({start.judges.points, data.normals(Eigen::all, few)});
  TakeMoments(start);
  return start;
}

double ScaleAbout(const FittedSurface& shape, const ShapeData& points, ThreadPool& pool) {
  return RobustScale(SurfaceDistances(shape, points.points, pool));
}

// Tukey's loss at the scale of the points, down to σ.
FittedSurface Settled(FittedSurface shape,
                      const StartData& start,
                      const ShapeData& points,
                      double sigma,
                      int rounds,
                      ThreadPool& pool) {
  constexpr int kSteps = 8;
  constexpr double kSteady = 0.05;  // relative change of the scale
  shape = shape.TouchingNear(start.middle);
  double before = 0;
  for (int round = 0; round < rounds; ++round) {
    const double scale = std::max(sigma, ScaleAbout(shape, points, pool));
    if (std::abs(scale - before) <= kSteady * scale) break;
    before = scale;
    shape = Minimised(shape, points, {Loss::kTukey, scale}, kSteps, pool).shape;
  }
  return shape;
}

double CostOf(const FittedSurface& shape, const ShapeData& points, double sigma, ThreadPool& pool) {
  const double cost = FormOf(shape, points, {Loss::kTruncated, sigma}, pool).cost;
  return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
}

// The few starts nearest to the judges.
std::vector<FittedSurface> Nearest(std::vector<FittedSurface> starts,
                                   const StartData& start,
                                   std::size_t most,
                                   ThreadPool& pool) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const double scale = ScaleAbout(starts[k], start.judges, pool);
    if (std::isfinite(scale)) order.emplace_back(scale, k);
  }
  std::sort(order.begin(), order.end());
  std::vector<FittedSurface> few;
  for (const auto& [scale, k] : order) {
    if (few.size() < most) few.push_back(starts[k]);
  }
  return few;
}

}  // namespace

std::optional<FittedSurface> ShapeThrough(const RegionPoints& data,
                                          const std::vector<int>& members,
                                          SurfaceKind kind,
                                          double sigma,
                                          const FittedSurface* before) {
  constexpr std::size_t kFinalists = 4;
  constexpr int kFewRounds = 2, kRounds = 8;
  constexpr double kFarOff = 3;  // σ: of half the points, no shape that they do not reject
  if (members.size() < static_cast<std::size_t>(FreedomsOf(kind) + 1)) return std::nullopt;
  ThreadPool alone(1);
  const StartData start = StartsOf(data, members);
  std::vector<FittedSurface> starts;
  if (before != nullptr) {
    starts.push_back(*before);
  } else {
    starts = MomentStarts(kind, start);
    if (kind == SurfaceKind::kCone || kind == SurfaceKind::kTorus) {
      for (const FittedSurface& cylinder :
           Nearest(MomentStarts(SurfaceKind::kCylinder, start), start, 1, alone)) {
        const FittedSurface settled = Settled(cylinder, start, start.judges, sigma, kRounds, alone);
        const auto more = StartsFromCylinder(kind, settled, start);
        starts.insert(starts.end(), more.begin(), more.end());
      }
    }
    starts = Nearest(std::move(starts), start, kFinalists, alone);
  }
  double scale = std::numeric_limits<double>::infinity();
  for (FittedSurface& one : starts) {
    one = Settled(one, start, start.judges, sigma, kFewRounds, alone);
    scale = std::min(scale, std::max(sigma, ScaleAbout(one, start.judges, alone)));
  }
  // Compared at the scale of the one that most points are closest to.
  std::optional<FittedSurface> best;
  double least = std::numeric_limits<double>::infinity();
  for (const FittedSurface& one : starts) {
    const double cost = CostOf(one, start.judges, scale, alone);
    if (!(cost < least)) continue;
    least = cost;
    best = one;
  }
  if (!best) return std::nullopt;
  best = Settled(*best, start, start.judges, sigma, kRounds, alone);
  if (!(ScaleAbout(*best, start.judges, alone) <= kFarOff * sigma)) return std::nullopt;
  return Settled(*best, start, start.sample, sigma, 2, alone);
}

ShapeTest TestShape(const RegionPoints& data,
                    const std::vector<int>& members,
                    const FittedSurface& shape,
                    double sigma) {
  constexpr double kLargest = 1.15;
  ShapeTest test;
  if (members.empty()) return test;
  const double most = kFarFromShape * sigma;
  std::vector<double> off(static_cast<std::size_t>(data.size()),
                          std::numeric_limits<double>::quiet_NaN());
  double squares = 0;
  for (const int k : members) {
    const double distance = std::clamp(shape.Distance(data.points.col(k)), -most, most);
    off[static_cast<std::size_t>(k)] = distance;
    squares += distance * distance;
  }
  const auto count = static_cast<double>(members.size());
  test.rms = std::sqrt(squares / std::max(1.0, count - FreedomsOf(shape.kind)));
  double shared = 0, pairs = 0;
  for (const int k : members) {
    for (const int other : data.Around(k)) {
      const double there = off[static_cast<std::size_t>(other)];
      if (other < k || std::isnan(there)) continue;
      shared += off[static_cast<std::size_t>(k)] * there;
      ++pairs;
    }
  }
  // The correlation of distances at neighbouring members, −1 … 1.
  const double trend = pairs > 0 && squares > 0 ? shared / pairs / (squares / count) : 0;
  const double chance = kThreeSigmas / std::sqrt(2 * count);
  const bool near = test.rms <= kLargest * (1 + chance) * sigma;
  const bool even = trend <= data.most_trend + kThreeSigmas / std::sqrt(std::max(1.0, pairs));
  test.passed = near && (even || test.rms <= data.rounding);
  return test;
}

double NormalOff(const RegionPoints& data, int point, const FittedSurface& shape) {
  const Eigen::Vector3d normal = data.normals.col(point);
  if (normal.isZero(0)) return 0;
  return normal.cross(shape.TouchingNear(data.points.col(point)).normal).norm();
}

}  // namespace batten::internal
