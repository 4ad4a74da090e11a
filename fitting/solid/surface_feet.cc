// SPDX-License-Identifier: MIT
#include "fitting/solid/surface_feet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "batten/fitting/neighbours.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"

namespace batten::internal {
namespace {

constexpr int kGrid = 3;  // samples a patch in each direction
constexpr int kCandidates =
    16;  // samples looked at: two walls nearer than a sample apart share them
constexpr int kSteps = 12;

// Whether a normal agrees with that of a point.
bool Agrees(const Eigen::Vector3d& normal, const Eigen::Vector3d& given, bool oriented) {
  if (given.isZero()) return true;
  const double cosine = normal.dot(given);
  return (oriented ? cosine : std::abs(cosine)) >= kLeastCosine;
}

// Newton's method from a place, each step halved until it comes nearer.
void Descend(const LimitSurface& surface, const Eigen::Vector3d& q, LimitFoot& foot) {
  SurfaceJet jet = surface.JetAt(foot.place);
  double square = (jet.point - q).squaredNorm();
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::Vector3d d = jet.point - q;
    const Eigen::Vector2d slope(jet.du.dot(d), jet.dv.dot(d));
    Eigen::Matrix2d first;
    first << jet.du.squaredNorm(), jet.du.dot(jet.dv), jet.du.dot(jet.dv), jet.dv.squaredNorm();
    Eigen::Matrix2d second = first;
    second(0, 0) += jet.duu.dot(d);
    second(1, 1) += jet.dvv.dot(d);
    second(0, 1) = second(1, 0) = second(0, 1) + jet.duv.dot(d);
    // Where the distance is not convex, the plane's metric is.
    constexpr double kConvex = 0.1;
    const bool convex = second.determinant() > kConvex * first.determinant() && second(0, 0) > 0;
    Eigen::Vector2d move = -(convex ? second : first).inverse() * slope;
    // Along a crease that the step would cross, if not over its end.
    const LimitSurface::Creases creases = surface.CreasesAt(foot.place);
    const bool left = creases.left && move[0] < 0, down = creases.down && move[1] < 0;
    if (left) move = {0, -slope[1] / (convex ? second : first)(1, 1)};
    if (down) move = {left ? 0 : -slope[0] / (convex ? second : first)(0, 0), 0};
    if (!move.allFinite() || move.isZero()) break;
    constexpr double kLongest = 0.7;  // of a patch
    move *= std::min(1.0, kLongest / move.cwiseAbs().maxCoeff());
    bool nearer = false;
    for (int halving = 0; halving < 5 && !nearer; ++halving, move /= 2) {
      const LimitPlace place = surface.Moved(foot.place, move[0], move[1]);
      const SurfaceJet there = surface.JetAt(place);
      const double its = (there.point - q).squaredNorm();
      if (its >= square) continue;
      nearer = true;
      const bool done = its > square * (1 - 1e-10) || move.norm() < 1e-8;
      foot.place = place;
      jet = there;
      square = its;
      if (done) halving = kSteps, step = kSteps;
    }
    if (!nearer) break;
  }
  foot.point = jet.point;
  foot.normal = jet.du.cross(jet.dv).stableNormalized();
  const LimitSurface::Creases creases = surface.CreasesAt(foot.place);
  foot.on_crease = creases.left || creases.down;
  foot.tangent.setZero();
  if (creases.left != creases.down) {
    foot.tangent = (creases.down ? jet.du : jet.dv).stableNormalized();
  }
}

// Whether the normal of a foot agrees; on a crease that is the mean of both sides'.
bool IsFound(const FootGround& ground,
             const LimitFoot& foot,
             const Eigen::Vector3d& given,
             bool oriented) {
  Eigen::Vector3d normal = foot.normal;
  for (const LimitPlace& beyond : ground.surface.Beyond(foot.place)) {
    if (!ground.Has(beyond.patch)) continue;
    const SurfaceJet jet = ground.surface.JetAt(beyond);
    normal += jet.du.cross(jet.dv).stableNormalized();
  }
  return Agrees(normal.stableNormalized(), given, oriented);
}

// The same, and on from creases over them for as long as that comes nearer.
void DescendOverCreases(const FootGround& ground, const Eigen::Vector3d& q, LimitFoot& foot) {
  Descend(ground.surface, q, foot);
  constexpr int kMost = 4;
  for (int round = 0; round < kMost; ++round) {
    const double square = (foot.point - q).squaredNorm();
    LimitFoot best = foot;
    for (const LimitPlace& beyond : ground.surface.Beyond(foot.place)) {
      if (!ground.Has(beyond.patch)) continue;
      LimitFoot other;
      other.place = beyond;
      Descend(ground.surface, q, other);
      const double nearer = (1 - kRelativelyEqual) * (best.point - q).squaredNorm();
      if ((other.point - q).squaredNorm() < nearer) best = other;
    }
    if (!((best.point - q).squaredNorm() < square)) return;
    foot = best;
  }
}

// Places spread over the ground.
struct Samples {
  std::vector<LimitPlace> places;
  Eigen::Matrix3Xd points, normals;

  Samples(const FootGround& ground, ThreadPool& pool) {
    for (int patch = 0; patch < ground.patches; ++patch) {
      if (!ground.Has(patch)) continue;
      for (int i = 0; i < kGrid; ++i) {
        for (int j = 0; j < kGrid; ++j) {
          places.push_back({patch, (i + 0.5) / kGrid, (j + 0.5) / kGrid});
        }
      }
    }
    const auto count = Eigen::Index(places.size());
    points.resize(3, count);
    normals.resize(3, count);
    pool.For(count, kSlowPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t k = begin; k < end; ++k) {
        const SurfaceJet jet = ground.surface.JetAt(places[std::size_t(k)]);
        points.col(k) = jet.point;
        normals.col(k) = jet.du.cross(jet.dv).stableNormalized();
      }
    });
  }
};

}  // namespace

std::vector<LimitFoot> FeetOn(const FootGround& ground,
                              const Eigen::Matrix3Xd& points,
                              const Eigen::Matrix3Xd& normals,
                              bool oriented,
                              const std::vector<LimitFoot>& from,
                              ThreadPool& pool) {
  std::vector<LimitFoot> feet = from;
  std::unique_ptr<Samples> samples;
  std::vector<int> nearest;
  int candidates = 0;
  if (from.empty()) {
    feet.resize(std::size_t(points.cols()));
    samples = std::make_unique<Samples>(ground, pool);
    candidates = std::min<int>(kCandidates, static_cast<int>(samples->places.size()));
    nearest = NeighbourIndex(samples->points, pool).Nearest(points, candidates);
  }
  pool.For(points.cols(), kSlowPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      LimitFoot& foot = feet[std::size_t(k)];
      const Eigen::Vector3d given = normals.cols() > 0 ? Eigen::Vector3d(normals.col(k))
                                                       : Eigen::Vector3d(Eigen::Vector3d::Zero());
      if (from.empty()) {
        const int* first = &nearest[std::size_t(k) * std::size_t(candidates)];
        const int* chosen = std::find_if(first, first + candidates, [&](int s) {
          return Agrees(samples->normals.col(s), given, oriented);
        });
        foot.place = samples->places[std::size_t(chosen < first + candidates ? *chosen : *first)];
      }
      DescendOverCreases(ground, points.col(k), foot);
      foot.found = IsFound(ground, foot, given, oriented);
    }
  });
  return feet;
}

}  // namespace batten::internal
