// SPDX-License-Identifier: MIT
#include "fitting/primitives/sphere_patch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "batten/fitting/point_mask.h"
#include "fitting/primitives/angle_extent.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

constexpr double kHole = std::numbers::pi / 6;  // radius of the widest empty cap that is closed

// The patch about an axis.
SphereCover About(const Eigen::Vector3d& axis,
                  const Eigen::Vector3d& x,
                  const Eigen::Matrix3Xd& directions) {
  const Eigen::Vector3d y = axis.cross(x);
  SphereCover cover{axis, x, {}, {kTurn / 4, -kTurn / 4}};
  std::vector<double> longitudes;
  for (Eigen::Index k = 0; k < directions.cols(); ++k) {
    const Eigen::Vector3d d = directions.col(k);
    const double a = d.dot(x), b = d.dot(y);
    longitudes.push_back(std::atan2(b, a));
    const double latitude = std::atan2(d.dot(axis), std::hypot(a, b));
    cover.latitude.lower = std::min(cover.latitude.lower, latitude);
    cover.latitude.upper = std::max(cover.latitude.upper, latitude);
  }
  cover.longitude = AnglesCovered(longitudes);
  if (cover.longitude.full()) {
    if (cover.latitude.lower < kHole - kTurn / 4) cover.latitude.lower = -kTurn / 4;
    if (cover.latitude.upper > kTurn / 4 - kHole) cover.latitude.upper = kTurn / 4;
  }
  return cover;
}

double AreaOf(const SphereCover& cover) {
  return cover.longitude.sweep * (std::sin(cover.latitude.upper) - std::sin(cover.latitude.lower));
}

// The direction farthest from all given directions, and its angle from the nearest.
struct EmptyCap {
  Eigen::Vector3d middle;
  double radius = 0;
};

EmptyCap LargestEmptyCap(const Eigen::Matrix3Xd& directions) {
  constexpr int kProbes = 600;
  EmptyCap cap{Eigen::Vector3d::UnitZ()};
  double least = 2;
  for (int k = 0; k < kProbes; ++k) {
    const double z = 1 - (2 * k + 1.0) / kProbes, angle = k * std::numbers::pi * (3 - std::sqrt(5));
    const double r = std::sqrt(1 - z * z);
    const Eigen::Vector3d probe(r * std::cos(angle), r * std::sin(angle), z);
    const double nearest = (probe.transpose() * directions).maxCoeff();
    if (nearest < least) {
      least = nearest;
      cap = {probe, std::acos(std::clamp(nearest, -1.0, 1.0))};
    }
  }
  return cap;
}

}  // namespace

SphereCover CoverOf(const Eigen::Matrix3Xd& directions) {
  constexpr Eigen::Index kSome = 3000;
  constexpr int kTurns = 18;
  constexpr double kSparse = 3;  // holes between so few points are wider
  const Eigen::Matrix3Xd some = directions(Eigen::all, SampleIndices(directions.cols(), kSome, 1));
  const EmptyCap empty = LargestEmptyCap(some);
  const double closed =
      std::max(kHole, kSparse / std::sqrt(static_cast<double>(directions.cols())));
  if (empty.radius <= closed) {
    return {
        Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(), {0, kTurn}, {-kTurn / 4, kTurn / 4}};
  }
  Eigen::Vector3d middle = directions.rowwise().mean();
  middle = middle.norm() > 0 ? middle.normalized() : Eigen::Vector3d(-empty.middle);
  std::vector<Eigen::Vector3d> axes{middle, empty.middle};
  const Eigen::Vector3d across = middle.unitOrthogonal();
  for (int k = 0; k < kTurns; ++k) {
    axes.emplace_back(Eigen::AngleAxisd(k * std::numbers::pi / kTurns, middle) * across);
  }
  SphereCover best;
  double least = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& axis : axes) {
    Eigen::Vector3d x = middle - middle.dot(axis) * axis;
    constexpr double kAlong = 1e-6;
    x = x.norm() > kAlong ? x.normalized() : axis.unitOrthogonal();
    const SphereCover cover = About(axis, x, some);
    if (AreaOf(cover) < least) {
      least = AreaOf(cover);
      best = cover;
    }
  }
  return About(best.axis, best.x, directions);
}

}  // namespace batten::internal
