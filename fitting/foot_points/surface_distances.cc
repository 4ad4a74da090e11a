// SPDX-License-Identifier: MIT
#include "fitting/foot_points/surface_distances.h"

#include <algorithm>
#include <atomic>
#include <vector>

#include "batten/geometry/insert_knots.h"
#include "batten/geometry/local_foot_points.h"
#include "fitting/core/shared_constants.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kAsked = 512;  // points that tell how many have no proof

// Cost of a piece over that of a search: 24 and 3 µs. Cut where that takes at most a quarter of
// what the searches would; finer cuts than 4 give proof to 1 % more of points (wavy terrain).
constexpr double kSearchesPerPiece = 8, kOfSearches = 0.25;
constexpr int kMostCuts = 4;

// A start for every point: the given guess of its foot parameters, or any place.
Eigen::Matrix2Xd StartsFrom(const NurbsSurface& surface, const Eigen::Matrix2Xd& near) {
  const Eigen::Vector2d any(surface.basis_u().lower(), surface.basis_v().lower());
  Eigen::Matrix2Xd starts = near;
  for (Eigen::Index k = 0; k < near.cols(); ++k) {
    if (!near.col(k).allFinite()) starts.col(k) = any;
  }
  return starts;
}

// Knots that cut every span into so many of equal length.
std::vector<double> CutsOf(const SplineBasis& basis, int cuts) {
  std::vector<double> knots;
  for (const int span : basis.Spans()) {
    const auto at = static_cast<std::size_t>(span);
    const double low = basis.knots()[at], high = basis.knots()[at + 1];
    for (int k = 1; k < cuts; ++k) knots.push_back(low + (high - low) * k / cuts);
  }
  return knots;
}

double Pieces(const NurbsSurface& surface) {
  return static_cast<double>(surface.basis_u().Spans().size()) *
         static_cast<double>(surface.basis_v().Spans().size());
}

}  // namespace

SurfaceDistances::SurfaceDistances(const NurbsSurface& surface,
                                   double expected,
                                   const Eigen::Matrix3Xd& some,
                                   const Eigen::Matrix2Xd& near,
                                   ThreadPool& pool)
    : evaluator_(surface), finder_(surface) {
  const double saved = kOfSearches / kSearchesPerPiece * expected / Pieces(surface);
  if (surface.rational() || some.cols() == 0 || saved < 4) return;
  const double share = ShareWithoutProof(some, near, pool);
  int cuts = 1;
  while (2 * cuts <= kMostCuts && 4.0 * cuts * cuts <= saved * share) cuts *= 2;
  if (cuts == 1) return;
  const NurbsSurface in_u = RefineKnots(surface, Direction::kU, CutsOf(surface.basis_u(), cuts));
  fine_.emplace(RefineKnots(in_u, Direction::kV, CutsOf(surface.basis_v(), cuts)));
}

double SurfaceDistances::ShareWithoutProof(const Eigen::Matrix3Xd& some,
                                           const Eigen::Matrix2Xd& near,
                                           ThreadPool& pool) const {
  const Eigen::Index step = std::max<Eigen::Index>(1, some.cols() / kAsked);
  const Eigen::Matrix3Xd points = some(Eigen::all, Eigen::seq(0, Eigen::last, step));
  const Eigen::Matrix2Xd guesses = near(Eigen::all, Eigen::seq(0, Eigen::last, step));
  const auto feet =
      LocalFootPoints(evaluator_, points, StartsFrom(evaluator_.surface(), guesses), pool);
  Eigen::Index without = 0;
  for (Eigen::Index k = 0; k < points.cols(); ++k)
    without +=
        finder_.SurelyNearest(points.col(k), feet.parameters(0, k), feet.parameters(1, k)) ? 0 : 1;
  return static_cast<double>(without) / static_cast<double>(points.cols());
}

// Finds local foot points first, many at a time; most are provably the nearest.
PointDistances SurfaceDistances::To(const Eigen::Matrix3Xd& points,
                                    const Eigen::Matrix2Xd& near,
                                    ThreadPool& pool) const {
  const bool all = near.allFinite();
  auto feet = LocalFootPoints(
      evaluator_, points, all ? near : StartsFrom(evaluator_.surface(), near), pool);
  std::atomic<Eigen::Index> uncertified = 0;
  pool.For(points.cols(), kSlowPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const double u = feet.parameters(0, k), v = feet.parameters(1, k);
      if (SurelyNearest(points.col(k), u, v)) continue;
      const bool known = all || near.col(k).allFinite();
      const SurfaceFoot foot =
          known ? finder_.NearestFrom(points.col(k), u, v) : finder_.Nearest(points.col(k));
      feet.distances[k] = SignedDistance(evaluator_, points.col(k), foot);
      feet.parameters.col(k) << foot.u, foot.v;
      if (!foot.certified) ++uncertified;
    }
  });
  return {std::move(feet.distances), std::move(feet.parameters), uncertified};
}

double SignedDistance(const SurfaceEvaluator& surface,
                      const Eigen::Vector3d& q,
                      const SurfaceFoot& foot) {
  const auto normal = surface.NormalAt(foot.u, foot.v);
  const bool below = normal && normal->dot(q - foot.point) < 0;
  return below ? -foot.distance : foot.distance;
}

}  // namespace batten::internal
