// SPDX-License-Identifier: MIT
#include "fitting/streaming/foot_guesses.h"

#include <vector>

#include "fitting/core/shared_constants.h"

namespace batten::internal {

FootGuesses::FootGuesses(const NurbsSurface& surface,
                         double expected,
                         const Eigen::Matrix3Xd& sample,
                         ThreadPool& pool)
    : index_(sample, pool),
      of_sample_(DistancesTo(surface, sample, pool)),
      surface_(surface, expected, sample, of_sample_.parameters, pool) {}

PointDistances FootGuesses::DistancesOf(const Eigen::Matrix3Xd& points, ThreadPool& pool) const {
  Eigen::Matrix2Xd near(2, points.cols());
  pool.For(points.cols(), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const std::vector<int> nearest = index_.Nearest(points.middleCols(begin, end - begin), 1);
    for (std::ptrdiff_t k = begin; k < end; ++k)
      near.col(k) = of_sample_.parameters.col(nearest[static_cast<std::size_t>(k - begin)]);
  });
  return surface_.To(points, near, pool);
}

}  // namespace batten::internal
