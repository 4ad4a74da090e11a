// SPDX-License-Identifier: MIT
#include "batten/fitting/distances.h"

#include <cmath>

namespace batten {
namespace {

// The distance with the side of the surface the point is on.
double Signed(const NurbsSurface& surface, const SurfaceFoot& foot, const Eigen::Vector3d& q) {
  const auto normal = surface.NormalAt(foot.u, foot.v);
  return normal && normal->dot(q - foot.point) < 0 ? -foot.distance : foot.distance;
}

}  // namespace

PointDistances DistancesTo(const NurbsSurface& surface,
                           const Eigen::Matrix3Xd& points,
                           ThreadPool& pool) {
  const SurfaceFootPoints finder(surface);
  PointDistances result{Eigen::VectorXd(points.cols()), Eigen::MatrixXd(2, points.cols())};
  pool.For(points.cols(), 256, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const SurfaceFoot foot = finder.Nearest(points.col(k));
      result.distances[k] = Signed(surface, foot, points.col(k));
      result.parameters.col(k) << foot.u, foot.v;
    }
  });
  return result;
}

PointDistances DistancesFrom(const NurbsSurface& surface,
                             const Eigen::Matrix3Xd& points,
                             const Eigen::Matrix2Xd& start,
                             ThreadPool& pool) {
  PointDistances result{Eigen::VectorXd(points.cols()), Eigen::MatrixXd(2, points.cols())};
  pool.For(points.cols(), 256, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const SurfaceFoot foot = LocalFootPoint(surface, points.col(k), start(0, k), start(1, k));
      result.distances[k] = Signed(surface, foot, points.col(k));
      result.parameters.col(k) << foot.u, foot.v;
    }
  });
  return result;
}

}  // namespace batten
