// SPDX-License-Identifier: MIT
#include "fitting/primitives/surface_minimum.h"

#include <Eigen/Geometry>
#include <cmath>

#include "fitting/core/shared_constants.h"
#include "fitting/primitives/surface_distance.h"

namespace batten::internal {
namespace {

// The sums over a block, the lower triangle of the matrix only.
template <SurfaceKind kKind, bool kLossy>
SurfaceForm BlockForm(const SurfaceDistance<kKind>& distance_of,
                      const ShapeData& data,
                      const ShapeLoss& loss,
                      Eigen::Index begin,
                      Eigen::Index end) {
  constexpr int kFreedoms = FreedomsOf(kKind);
  double products[kFreedoms * (kFreedoms + 1) / 2] = {}, gradient[kFreedoms] = {}, cost = 0;
  for (Eigen::Index k = begin; k < end; ++k) {
    typename SurfaceDistance<kKind>::Row row;
    const double distance = distance_of(data.points.col(k), row);
    double weight = data.weights[k];
    if constexpr (kLossy) {
      cost += weight * LossValue(loss.loss, distance, loss.scale);
      weight *= LossWeight(loss.loss, distance, loss.scale);
      if (!(weight > 0)) continue;
    } else {
      cost += weight * distance * distance / 2;
    }
    int at = 0;
    for (int i = 0; i < kFreedoms; ++i) {
      const double weighted = weight * row[i];
      gradient[i] += weighted * distance;
      for (int j = 0; j <= i; ++j) products[at++] += weighted * row[j];
    }
  }
  SurfaceForm form;
  form.cost = cost;
  int at = 0;
  for (int i = 0; i < kFreedoms; ++i) {
    form.gradient[i] = gradient[i];
    for (int j = 0; j <= i; ++j) form.matrix(i, j) = form.matrix(j, i) = products[at++];
  }
  return form;
}

}  // namespace

SurfaceForm FormOf(const FittedSurface& shape,
                   const ShapeData& data,
                   const ShapeLoss& loss,
                   ThreadPool& pool) {
  return WithKind(shape.kind, [&]<SurfaceKind kKind>() {
    const SurfaceDistance<kKind> distance_of(shape);
    const auto part = [&](Eigen::Index begin, Eigen::Index end) {
      return loss.loss == Loss::kNone ? BlockForm<kKind, false>(distance_of, data, loss, begin, end)
                                      : BlockForm<kKind, true>(distance_of, data, loss, begin, end);
    };
    return SumOfBlocks<kSumBlock>(data.points.cols(), part, pool);
  });
}

FittedSurface Moved(const FittedSurface& shape, const Eigen::Matrix<double, 7, 1>& step) {
  FittedSurface moved = shape;
  moved.point += step[0] * shape.normal;
  const Eigen::Vector3d turn =
      step[1] * shape.Across() + step[2] * shape.along + step[4] * shape.normal;
  const double angle = turn.norm();
  if (angle > 0) {
    const Eigen::AngleAxisd rotation(angle, turn / angle);
    moved.normal = (rotation * shape.normal).normalized();
    moved.along = rotation * shape.along;
    moved.along = (moved.along - moved.along.dot(moved.normal) * moved.normal).normalized();
  }
  (shape.kind == SurfaceKind::kSphere ? moved.curvature : moved.axis_curvature) += step[3];
  moved.slope += step[5];
  moved.curvature += step[6];
  return moved;
}

SurfaceMinimum Minimised(const FittedSurface& start,
                         const ShapeData& data,
                         const ShapeLoss& loss,
                         int most_steps,
                         ThreadPool& pool) {
  constexpr double kNoise = 1e-7;  // of the size: more than this hides the last digits
  return ShapeDescent<FittedSurface, 7>::Run(
      start,
      [&](const FittedSurface& shape) { return FormOf(shape, data, loss, pool); },
      [](const FittedSurface& shape, const auto& step) { return Moved(shape, step); },
      FreedomsOf(start.kind),
      data.weights.sum(),
      kNoise,
      most_steps);
}

Eigen::VectorXd SurfaceDistances(const FittedSurface& shape,
                                 const Eigen::Matrix3Xd& points,
                                 ThreadPool& pool) {
  Eigen::VectorXd distances(points.cols());
  WithKind(shape.kind, [&]<SurfaceKind kKind>() {
    const SurfaceDistance<kKind> distance_of(shape);
    pool.For(points.cols(), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      typename SurfaceDistance<kKind>::Row row;
      for (std::ptrdiff_t k = begin; k < end; ++k) distances[k] = distance_of(points.col(k), row);
    });
  });
  return distances;
}

}  // namespace batten::internal
