// SPDX-License-Identifier: MIT
#include "fitting/streaming/all_distances.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace batten::internal {

DistanceMeter::DistanceMeter(const NurbsSurface& surface,
                             const Parameterization& base,
                             double expected,
                             const Eigen::Matrix3Xd& sample,
                             ThreadPool& pool)
    : plane_(base.plane) {
  if (!plane_) {
    guesses_.emplace(surface, expected, sample, pool);
    of_sample_ = guesses_->of_sample();
    return;
  }
  heights_ = HeightDistances::Of(surface, *plane_, pool);
  if (heights_) {
    of_sample_ = heights_->To(sample, pool);
    return;
  }
  const Eigen::Matrix2Xd near = plane_->ToFrame(sample).topRows<2>();
  over_plane_.emplace(surface, expected, sample, near, pool);
  of_sample_ = over_plane_->To(sample, near, pool);
}

PointDistances DistanceMeter::Of(const Eigen::Matrix3Xd& points, ThreadPool& pool) const {
  if (heights_) return heights_->To(points, pool);
  return plane_ ? over_plane_->To(points, plane_->ToFrame(points).topRows<2>(), pool)
                : guesses_->DistancesOf(points, pool);
}

AllDistances::AllDistances(double unit, std::optional<double> tolerance, double limit_of_used)
    : used(unit, tolerance), all(unit, tolerance), limit(limit_of_used) {}

void AllDistances::Add(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& distances) {
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double size = std::abs(distances[k]);
    all.Add(distances[k]);
    if (size > limit) {
      beyond.extend(points.col(k));
      continue;
    }
    if (size >= used.greatest()) farthest = points.col(k);
    used.Add(distances[k]);
  }
}

AllDistances::Extremes AllDistances::extremes() const {
  const Eigen::Vector3d &at = farthest, &low = beyond.min(), &high = beyond.max();
  return {used.greatest(),
          all.greatest(),
          at[0],
          at[1],
          at[2],
          low[0],
          low[1],
          low[2],
          high[0],
          high[1],
          high[2]};
}

void AllDistances::set_extremes(const Extremes& one) {
  used.set_greatest(one[0]);
  all.set_greatest(one[1]);
  farthest = {one[2], one[3], one[4]};
  beyond.min() = {one[5], one[6], one[7]};
  beyond.max() = {one[8], one[9], one[10]};
}

void AllDistances::Merge(PointSource& source) {
  source.Sum(used.numbers());
  source.Sum(all.numbers());
  const Extremes own = extremes();
  const std::vector<double> every = source.Gathered({own.begin(), own.end()});
  for (std::size_t k = 0; k < every.size(); k += own.size()) {
    const double* one = every.data() + k;
    if (one[0] > used.greatest()) farthest = Eigen::Vector3d(one[2], one[3], one[4]);
    used.set_greatest(std::max(used.greatest(), one[0]));
    all.set_greatest(std::max(all.greatest(), one[1]));
    if (one[5] > one[8]) continue;  // an empty box
    beyond.extend(Eigen::Vector3d(one[5], one[6], one[7]));
    beyond.extend(Eigen::Vector3d(one[8], one[9], one[10]));
  }
}

}  // namespace batten::internal
