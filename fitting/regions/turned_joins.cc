// SPDX-License-Identifier: MIT
#include "fitting/regions/turned_joins.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "fitting/primitives/algebraic_fits.h"
#include "fitting/regions/region_shape.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Axis AxisOf(const FittedSurface& shape) { return {shape.OnAxis(), shape.Axis()}; }

// Heights along the axis and distances from it.
Eigen::Matrix2Xd ProfileOf(const Eigen::Matrix3Xd& points, const Axis& axis) {
  return MeridianOf(points, axis).colwise().reverse();
}

// The straight profile of least squares, turned.
std::optional<FittedSurface> Straight(const Eigen::Matrix2Xd& profile,
                                      const Axis& axis,
                                      const Vector3d& near) {
  constexpr double kAlong = 1e-3;  // sine: cones whose tip is a thousand times as far are none
  const Vector2d mean = profile.rowwise().mean();
  const Eigen::Matrix2Xd off = profile.colwise() - mean;
  const Eigen::Matrix2d spread = off * off.transpose();
  const double turn = std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1)) / 2;
  const double up = std::cos(turn), out = std::sin(turn);
  if (std::abs(out) < kAlong) return CylinderNear(near, axis.point, axis.direction, mean[1]);
  if (std::abs(up) < kAlong) return PlaneAt(axis.point + mean[0] * axis.direction, axis.direction);
  const Vector3d tip = axis.point + (mean[0] - mean[1] * up / out) * axis.direction;
  const bool widens = up * out > 0;
  return ConeNear(near,
                  tip,
                  widens ? axis.direction : Vector3d(-axis.direction),
                  std::abs(std::atan(out / up)));
}

// The round one, by the algebraic distance: of an arc's points within noise of it the same.
std::optional<FittedSurface> Round(const Eigen::Matrix2Xd& profile,
                                   const Axis& axis,
                                   const Vector3d& near) {
  const Vector2d mean = profile.rowwise().mean();
  const Eigen::Matrix2Xd off = profile.colwise() - mean;
  Eigen::MatrixX3d system(off.cols(), 3);
  system << 2 * off.transpose(), Eigen::VectorXd::Ones(off.cols());
  const Vector3d solved = LeastSquares(system, off.colwise().squaredNorm().transpose());
  const Vector2d center = mean + solved.head<2>();
  const double radius = std::sqrt(solved[2] + solved.head<2>().squaredNorm());
  if (!std::isfinite(radius) || !(center[1] > 0)) return std::nullopt;
  return TorusNear(
      near, axis.point + center[0] * axis.direction, axis.direction, center[1], radius);
}

bool Touch(const std::vector<FaceRelation>& relations, int a, int b) {
  return std::any_of(relations.begin(), relations.end(), [&](const FaceRelation& one) {
    return one.kind == RelationKind::kTangent &&
           std::minmax(one.first, one.second) == std::minmax(a, b);
  });
}

bool TouchesAny(const std::vector<FaceRelation>& relations, int face) {
  return std::any_of(relations.begin(), relations.end(), [&](const FaceRelation& one) {
    return one.kind == RelationKind::kTangent && (one.first == face || one.second == face);
  });
}

class JoinTurner {
 public:
  JoinTurner(const RegionPoints& data,
             double sigma,
             std::vector<FittedSurface> related,
             std::vector<RegionFace>& faces,
             std::vector<FaceRelation>& relations)
      : data_(data),
        sigma_(sigma),
        related_(std::move(related)),
        faces_(faces),
        relations_(relations),
        turned_(faces.size()) {}

  // Whether `face` is turned about the axis of `beside`, or the two are found to touch.
  bool Turn(int beside, int face, const Vector3d& near) {
    const FittedSurface& other = related_[std::size_t(beside)];
    if (other.kind < SurfaceKind::kCylinder || !TouchesAny(relations_, beside) ||
        Touch(relations_, beside, face)) {
      return false;
    }
    const bool touches = TouchesAny(relations_, face);
    if (touches && !turned_[std::size_t(beside)]) return false;
    const auto shape = touches ? std::optional(related_[std::size_t(face)])
                               : ShapeAbout(AxisOf(other), faces_[std::size_t(face)], near);
    if (!shape) return false;
    const SmoothContact contact{ContactKind::kRound, near};
    const auto gap = ContactGap(contact, other, *shape);
    constexpr double kNear = 0.01;  // spacings: no kink that points show
    const double most = kNear * data_.spacing + kFarFromShape * sigma_;
    if (!gap || !(gap->norm() <= most)) return false;
    if (!touches) Take(face, *shape);
    relations_.push_back({RelationKind::kTangent, beside, face, gap->norm(), most, contact, most});
    return true;
  }

 private:
  std::optional<FittedSurface> ShapeAbout(const Axis& axis,
                                          const RegionFace& face,
                                          const Vector3d& near) const {
    const Eigen::Matrix2Xd profile = ProfileOf(data_.points(Eigen::all, face.core), axis);
    // What the shape that it has leaves of its points is noise.
    const double noise = std::max(sigma_, face.numbers.scale / data_.unit);
    for (const auto& shape : {Straight(profile, axis, near), Round(profile, axis, near)}) {
      if (shape && TestShape(data_, face.core, *shape, noise).passed) return shape;
    }
    return std::nullopt;
  }

  void Take(int number, const FittedSurface& shape) {
    RegionFace& face = faces_[std::size_t(number)];
    std::erase_if(relations_, [&](const FaceRelation& one) {
      return one.first == number || one.second == number;
    });
    face.shape = shape;
    face.numbers.kind = Name(shape.kind);
    face.numbers.accuracy.reset();  // its own points do not tell them
    face.numbers.why = "turned about the axis of a face that it joins smoothly";
    related_[std::size_t(number)] = shape;
    turned_[std::size_t(number)] = true;
  }

  const RegionPoints& data_;
  const double sigma_;
  std::vector<FittedSurface> related_;
  std::vector<RegionFace>& faces_;
  std::vector<FaceRelation>& relations_;
  std::vector<bool> turned_;
};

}  // namespace

bool TurnBeside(const RegionPoints& data,
                const std::vector<FaceJoin>& joins,
                double sigma,
                std::vector<FittedSurface> related,
                std::vector<RegionFace>& faces,
                std::vector<FaceRelation>& relations) {
  JoinTurner turner(data, sigma, std::move(related), faces, relations);
  bool changed = false;
  for (bool again = true; again;) {
    again = std::any_of(joins.begin(), joins.end(), [&](const FaceJoin& join) {
      return turner.Turn(join.first, join.second, join.near) ||
             turner.Turn(join.second, join.first, join.near);
    });
    changed = changed || again;
  }
  return changed;
}

}  // namespace batten::internal
