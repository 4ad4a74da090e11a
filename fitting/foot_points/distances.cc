// SPDX-License-Identifier: MIT
#include "batten/fitting/distances.h"

#include <atomic>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/geometry/local_foot_points.h"
#include "batten/geometry/surface_evaluator.h"
#include "fitting/core/shared_constants.h"
#include "fitting/foot_points/surface_distances.h"

namespace batten {
using namespace internal;

std::string UncertifiedText(Eigen::Index count) {
  if (count == 1)
    return "of one point it is not proved that no place is nearer: its distance is an upper bound";
  return "of " + std::to_string(count) +
         " points it is not proved that no place is nearer: their distances are upper bounds";
}

PointDistances DistancesTo(const NurbsSurface& surface,
                           const Eigen::Matrix3Xd& points,
                           ThreadPool& pool) {
  const SurfaceFootPoints finder(surface);
  const SurfaceEvaluator evaluator(surface);
  PointDistances result{Eigen::VectorXd(points.cols()), Eigen::MatrixXd(2, points.cols())};
  std::atomic<Eigen::Index> uncertified = 0;
  pool.For(points.cols(), kSlowPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const SurfaceFoot foot = finder.Nearest(points.col(k));
      result.distances[k] = SignedDistance(evaluator, points.col(k), foot);
      result.parameters.col(k) << foot.u, foot.v;
      if (!foot.certified) ++uncertified;
    }
  });
  result.uncertified = uncertified;
  return result;
}

PointDistances DistancesTo(const NurbsSurface& surface,
                           const Eigen::Matrix3Xd& points,
                           const Eigen::Matrix2Xd& near,
                           ThreadPool& pool) {
  if (near.cols() != points.cols()) {
    throw std::invalid_argument("DistancesTo: " + std::to_string(near.cols()) +
                                " places do not fit " + std::to_string(points.cols()) + " points");
  }
  const auto expected = static_cast<double>(points.cols());
  return SurfaceDistances(surface, expected, points, near, pool).To(points, near, pool);
}

PointDistances DistancesFrom(const NurbsSurface& surface,
                             const Eigen::Matrix3Xd& points,
                             const Eigen::Matrix2Xd& start,
                             ThreadPool& pool) {
  auto feet = LocalFootPoints(SurfaceEvaluator(surface), points, start, pool);
  return {std::move(feet.distances), std::move(feet.parameters)};
}

}  // namespace batten
