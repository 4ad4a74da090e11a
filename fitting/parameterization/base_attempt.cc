// SPDX-License-Identifier: MIT
#include "fitting/parameterization/base_attempt.h"

#include <algorithm>
#include <utility>

#include "fitting/core/mask_indices.h"

namespace batten::internal {

BaseInput::BaseInput(const PointCloud& cloud,
                     const NeighbourIndex& index,
                     const CloudStatistics& statistics,
                     const SurfaceFitOptions& options,
                     ThreadPool& pool)
    : cloud(cloud),
      statistics(statistics),
      options(options),
      pool(pool),
      index_(index),
      places_(IndicesOf(!statistics.outliers)) {
  if (std::ssize(places_) == cloud.size()) return;
  Eigen::Matrix3Xd points = cloud.points()(Eigen::all, places_);
  NeighbourIndex own(points);
  own_.emplace(Own{std::move(points), std::move(own)});
}

double BaseInput::margin() const {
  constexpr double kWidest =
      0.1;  // of the diagonal: of a handful of points both are about as large
  const Eigen::Matrix3Xd& points = inliers();
  const double diagonal = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  return std::min(statistics.spacing / 2 + 2 * statistics.noise, kWidest * diagonal);
}

BaseAttempt Attempt(const BaseInput& input,
                    const InlierSubset& some,
                    Parameterization&& base,
                    const PointMask& reached) {
  const Eigen::Index count = input.cloud.size();
  BaseAttempt made{std::move(base), PointMask::Constant(count, false)};
  made.complete = !some;
  const Eigen::Matrix2Xd parameters = std::move(made.base.parameters);
  made.base.parameters = Eigen::Matrix2Xd::Zero(2, count);
  for (Eigen::Index k = 0; k < parameters.cols(); ++k) {
    const auto inlier = static_cast<size_t>(some ? (*some)[static_cast<size_t>(k)] : k);
    const Eigen::Index place = input.places()[inlier];
    made.base.parameters.col(place) = parameters.col(k);
    made.reached[place] = reached[k];
  }
  return made;
}

BaseAttempt Failure(std::string reason) {
  BaseAttempt failed;
  failed.failure_reason = std::move(reason);
  return failed;
}

}  // namespace batten::internal
