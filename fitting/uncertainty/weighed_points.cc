// SPDX-License-Identifier: MIT
#include "fitting/uncertainty/weighed_points.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fitting/uncertainty/spline_shape.h"

namespace batten::internal {
namespace {

constexpr double kLeastSlope = 0.1;  // a loss that leaves less has left the points

// Turns offsets into pulls under the loss, whose scale is the fit's or that of the offsets.
WeighedPoints UnderLoss(const FitEstimator& estimator, WeighedPoints points) {
  const Eigen::VectorXd distances = points.pulls.colwise().norm();
  points.pulled = Eigen::VectorXd::Ones(points.size());
  if (estimator.loss == Loss::kNone) return points;
  const double scale = estimator.loss_scale.value_or(RobustScale(distances));
  if (!(scale > 0)) return points;
  points.pulled = LossWeights(estimator.loss, distances, scale);
  const auto pull = [&](double d) { return d * LossWeight(estimator.loss, d, scale); };
  const double step = 1e-4 * scale;
  double slopes = 0;
  for (Eigen::Index k = 0; k < points.size(); ++k) {
    const double d = distances[k];
    const double along = (pull(d + step) - pull(d - step)) / (2 * step);
    // Across the offset a pull turns with it.
    slopes += (along + (points.components - 1) * points.pulled[k]) / points.components;
    points.pulls.col(k) *= points.pulled[k];
  }
  points.slope = std::max(kLeastSlope, slopes / static_cast<double>(points.size()));
  return points;
}

Eigen::VectorXd OwnWeights(const PointCloud& cloud, const std::vector<Eigen::Index>& used) {
  if (cloud.weights().size() == 0)
    return Eigen::VectorXd::Ones(static_cast<Eigen::Index>(used.size()));
  return cloud.weights()(used);
}

}  // namespace

WeighedPoints Weigh(const SurfaceFit& fit, const PointCloud& cloud) {
  const std::vector<Eigen::Index> used = fit.estimator.UsedPoints(fit.outliers, cloud.size());
  WeighedPoints points;
  points.parameters = fit.parameters(Eigen::all, used);
  points.pulls = fit.residuals(used).transpose();
  points.weights = OwnWeights(cloud, used);
  return UnderLoss(fit.estimator, std::move(points));
}

template <int Dim>
WeighedPoints Weigh(const CurveFit<Dim>& fit, const PointCloud& cloud) {
  const std::vector<Eigen::Index> used = fit.estimator.UsedPoints(fit.outliers, cloud.size());
  const auto count = static_cast<Eigen::Index>(used.size());
  const SplineShape shape(fit.curve);
  WeighedPoints points;
  points.components = Dim - 1;
  points.parameters = Eigen::Matrix2Xd::Zero(2, count);
  points.parameters.row(0) = fit.parameters(used).transpose();
  points.pulls.resize(Dim == 2 ? 1 : 3, count);
  points.weights = OwnWeights(cloud, used);
  const Eigen::Vector3d move = cloud.origin() - fit.estimator.shift;
  for (Eigen::Index k = 0; k < count; ++k) {
    const double u = points.parameters(0, k);
    const ShapePlace place = PlaceOn(shape, u, 0);
    Eigen::Vector3d off = cloud.points().col(used[static_cast<size_t>(k)]) + move - place.position;
    if constexpr (Dim == 2) {
      points.pulls(0, k) = place.normal.dot(off);
    } else {
      const Eigen::Vector3d along = fit.curve.Derivatives(u, 1).col(1).normalized();
      points.pulls.col(k) = off - along.dot(off) * along;
    }
  }
  return UnderLoss(fit.estimator, std::move(points));
}

template WeighedPoints Weigh(const CurveFit<2>&, const PointCloud&);
template WeighedPoints Weigh(const CurveFit<3>&, const PointCloud&);

}  // namespace batten::internal
