// SPDX-License-Identifier: MIT
// Robust fits of shapes: a start by sample consensus, then MM-estimation at a scale estimated from
// the points.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "batten/fitting/point_mask.h"
#include "batten/fitting/statistics.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/shared_constants.h"
#include "fitting/primitives/shape_data.h"

namespace batten::internal {

// The shape of least median distance, or of least sum of Tukey's loss where the scale is known,
// among shapes through minimal random samples. Half of the points may be outliers: of 400 samples
// of three, 50 hold inliers only. The same seed gives the same shape. [Rousseeuw 1984; Torr &
// Zisserman 2000]
template <typename Shape>
std::optional<Shape> Consensus(const ShapeData& data,
                               std::optional<double> scale,
                               std::uint64_t seed) {
  constexpr int kSamples = 400;
  const std::vector<Eigen::Index> judges = SampleIndices(data.points.cols(), kShapeJudges, seed);
  std::mt19937_64 engine(seed);
  std::optional<Shape> best;
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> distances(judges.size());
  for (int k = 0; k < kSamples; ++k) {
    Eigen::Matrix3Xd sample(3, Shape::kSample);
    for (auto column : sample.colwise()) {
      column = data.points.col(
          static_cast<Eigen::Index>(engine() % static_cast<std::uint64_t>(data.points.cols())));
    }
    const std::optional<Shape> shape = Shape::Through(sample);
    if (!shape) continue;
    double score = 0;
    for (size_t j = 0; j < judges.size(); ++j) {
      distances[j] = shape->Distance(data.points.col(judges[j]));
      if (scale) score += LossValue(Loss::kTukey, distances[j], *scale);
    }
    if (!scale) score = Median(distances);
    if (score < least) {
      least = score;
      best = shape;
    }
  }
  return best;
}

template <typename Shape>
struct SmoothedShape {
  Shape shape;
  double scale = 1;
  std::vector<Eigen::Index> used;  // the points the fit uses, in increasing order
};

template <typename Shape>
Eigen::VectorXd ShapeDistances(const Shape& shape, const ShapeData& data, ThreadPool& pool) {
  Eigen::VectorXd distances(data.points.cols());
  pool.For(distances.size(), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      distances[k] = shape.Distance(data.points.col(k));
    }
  });
  return distances;
}

// The scale of the distances from a shape: 1.4826 times the median distance of the points to which
// Tukey's loss gives weight at the scale so far (infinite: of all points).
inline double ScaleOf(const Eigen::VectorXd& distances, double so_far) {
  std::vector<double> near;
  for (const double d : distances) {
    if (!std::isfinite(so_far) || LossWeight(Loss::kTukey, d, so_far) > 0) near.push_back(d);
  }
  return near.empty() ? so_far : kMadToSigma * Median(std::move(near));
}

// The points to which Tukey's loss gives weight.
inline std::vector<Eigen::Index> PointsNear(const Eigen::VectorXd& distances, double scale) {
  std::vector<Eigen::Index> near;
  for (Eigen::Index k = 0; k < distances.size(); ++k) {
    if (LossWeight(Loss::kTukey, distances[k], scale) > 0) near.push_back(k);
  }
  return near;
}

// The MM-estimate from `start`: first the shape of least Tukey loss at the scale given or, in
// rounds, at ScaleOf the points, never below `least_scale`; then the shape of least `loss` over the
// points to which Tukey's loss gives weight, at the same scale. Gross outliers, if fewer than half,
// count in no loss: Huber's and Cauchy's bound the pull of each, but would add it up. [Yohai 1987,
// MM-estimates]
template <typename Shape>
SmoothedShape<Shape> Settled(const ShapeData& data,
                             const Shape& start,
                             Loss loss,
                             std::optional<double> scale,
                             double least_scale,
                             ThreadPool& pool) {
  constexpr int kRounds = 40, kStepsARound = 4;
  constexpr double kSteady = 1e-3;
  SmoothedShape<Shape> settled{start, std::numeric_limits<double>::infinity(), {}};
  Eigen::VectorXd distances = ShapeDistances(settled.shape, data, pool);
  for (int round = 0; round < kRounds; ++round) {
    const double next = std::max(least_scale, scale ? *scale : ScaleOf(distances, settled.scale));
    if (std::abs(settled.scale - next) <= kSteady * next) break;
    settled.scale = next;
    settled.shape = settled.shape.Minimised(data, {Loss::kTukey, next}, kStepsARound, pool);
    distances = ShapeDistances(settled.shape, data, pool);
  }
  settled.shape =
      settled.shape.Minimised(data, {Loss::kTukey, settled.scale}, kMostIterations, pool);
  settled.used = PointsNear(ShapeDistances(settled.shape, data, pool), settled.scale);
  if (loss != Loss::kTukey) {
    const ShapeData near{
        data.points(Eigen::all, settled.used), data.weights(settled.used), data.plane};
    settled.shape = settled.shape.Minimised(near, {loss, settled.scale}, kMostIterations, pool);
  }
  return settled;
}

}  // namespace batten::internal
