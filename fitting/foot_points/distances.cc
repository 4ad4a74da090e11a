// SPDX-License-Identifier: MIT
#include "batten/fitting/distances.h"

#include <atomic>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/geometry/local_foot_points.h"
#include "batten/geometry/surface_evaluator.h"

namespace batten {
namespace {

constexpr std::ptrdiff_t kBlock = 256;

// The distance of a point from its foot, with the side of the surface the point is on.
double Signed(const SurfaceEvaluator& surface, const Eigen::Vector3d& q, const SurfaceFoot& foot) {
  const auto normal = surface.NormalAt(foot.u, foot.v);
  const bool below = normal && normal->dot(q - foot.point) < 0;
  return below ? -foot.distance : foot.distance;
}

// A start for every point: the given guess of its foot parameters, or any place.
Eigen::Matrix2Xd StartsFrom(const NurbsSurface& surface, const Eigen::Matrix2Xd& near) {
  const Eigen::Vector2d any(surface.basis_u().lower(), surface.basis_v().lower());
  Eigen::Matrix2Xd starts = near;
  for (Eigen::Index k = 0; k < near.cols(); ++k) {
    if (!near.col(k).allFinite()) starts.col(k) = any;
  }
  return starts;
}

}  // namespace

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
  pool.For(points.cols(), kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const SurfaceFoot foot = finder.Nearest(points.col(k));
      result.distances[k] = Signed(evaluator, points.col(k), foot);
      result.parameters.col(k) << foot.u, foot.v;
      if (!foot.certified) ++uncertified;
    }
  });
  result.uncertified = uncertified;
  return result;
}

// Finds local foot points first, many at a time; most are provably the nearest.
PointDistances DistancesTo(const NurbsSurface& surface,
                           const Eigen::Matrix3Xd& points,
                           const Eigen::Matrix2Xd& near,
                           ThreadPool& pool) {
  if (near.cols() != points.cols()) {
    throw std::invalid_argument("DistancesTo: " + std::to_string(near.cols()) +
                                " places do not fit " + std::to_string(points.cols()) + " points");
  }
  const SurfaceFootPoints finder(surface);
  const SurfaceEvaluator evaluator(surface);
  const bool all = near.allFinite();
  LocalFootPointsKernel feet =
      LocalFootPoints(evaluator, points, all ? near : StartsFrom(surface, near), pool);
  std::atomic<Eigen::Index> uncertified = 0;
  pool.For(points.cols(), kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const double u = feet.parameters(0, k), v = feet.parameters(1, k);
      if (finder.SurelyNearest(points.col(k), u, v)) continue;
      const bool known = all || near.col(k).allFinite();
      const SurfaceFoot foot =
          known ? finder.NearestFrom(points.col(k), u, v) : finder.Nearest(points.col(k));
      feet.distances[k] = Signed(evaluator, points.col(k), foot);
      feet.parameters.col(k) << foot.u, foot.v;
      if (!foot.certified) ++uncertified;
    }
  });
  return {std::move(feet.distances), std::move(feet.parameters), uncertified};
}

PointDistances DistancesFrom(const NurbsSurface& surface,
                             const Eigen::Matrix3Xd& points,
                             const Eigen::Matrix2Xd& start,
                             ThreadPool& pool) {
  LocalFootPointsKernel feet = LocalFootPoints(SurfaceEvaluator(surface), points, start, pool);
  return {std::move(feet.distances), std::move(feet.parameters)};
}

}  // namespace batten
