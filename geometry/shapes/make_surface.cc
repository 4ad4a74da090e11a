// SPDX-License-Identifier: MIT
#include "batten/geometry/make_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "geometry/numeric/construction_checks.h"
#include "geometry/shapes/axis_crossings.h"
#include "geometry/shapes/unit_arc.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kHalfTurn = std::numbers::pi;

SplineBasis LineBasis() { return SplineBasis(1, {0, 0, 1, 1}); }

// A profile by its basis, its control points (column: distance from the axis, height) and weights.
struct Profile {
  SplineBasis basis;
  Eigen::Matrix2Xd points;
  Eigen::VectorXd weights;
};

// The straight profile between two circles.
Profile StraightProfile(double radius_lower, double radius_upper, const Interval& height) {
  Eigen::Matrix2Xd points(2, 2);
  points << radius_lower, radius_upper, height.lower, height.upper;
  return {LineBasis(), std::move(points), Eigen::VectorXd::Ones(2)};
}

// The circle of radius `minor` at the distance `major` from the axis.
Profile RoundProfile(double major, double minor, const AngleRange& angles) {
  const UnitArc arc(angles);
  Eigen::Matrix2Xd points = minor * arc.points;
  points.row(0).array() += major;
  return {arc.basis, std::move(points), arc.weights};
}

NurbsSurface Turned(const Profile& profile, const Frame& frame, const AngleRange& angles) {
  const UnitArc arc(angles);
  const Eigen::Index around = arc.points.cols(), along = profile.points.cols();
  Eigen::Matrix3Xd points(3, around * along);
  Eigen::VectorXd weights(points.cols());
  for (Eigen::Index i = 0; i < around; ++i) {
    for (Eigen::Index j = 0; j < along; ++j) {
      const Eigen::Vector2d across = profile.points(0, j) * arc.points.col(i);
      points.col(i * along + j) = frame.At(across.x(), across.y(), profile.points(1, j));
      weights[i * along + j] = arc.weights[i] * profile.weights[j];
    }
  }
  return NurbsSurface(arc.basis, profile.basis, std::move(points), std::move(weights));
}

// A place of the profile with the two directions it moves in, all the length of its distance from
// the axis.
struct Ring {
  Eigen::Vector3d center, outward, forward;
};

Ring TorusSectionOf(const Eigen::Vector3d& point, const Frame& frame, double on_axis) {
  const Eigen::Vector3d from = point - frame.origin();
  const double height = from.dot(frame.axis());
  const Eigen::Vector3d outward = from - height * frame.axis();
  const Eigen::Vector3d foot = frame.origin() + height * frame.axis();
  if (!(outward.norm() > on_axis)) return {foot, {0, 0, 0}, {0, 0, 0}};
  return {foot, outward, frame.axis().cross(outward)};
}

// Whether the curve keeps its distance from the axis and its height, to 1e-9 of its
// extent and rounding: where it does at 2 p + 1 places of a span it does throughout.
bool GoesRound(const NurbsCurve<3>& curve, const Frame& frame) {
  constexpr double kSame = 1e-9, kRounding = 16 * std::numeric_limits<double>::epsilon();
  const Eigen::Matrix3Xd& points = curve.control_points();
  const double same =
      kSame * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm() +
      kRounding * std::max(points.cwiseAbs().maxCoeff(), frame.origin().cwiseAbs().maxCoeff());
  const SplineBasis& basis = curve.basis();
  const auto section = [&](double at) {
    const Ring ring = TorusSectionOf(curve.At(at), frame, 0);
    return Eigen::Vector2d(ring.outward.norm(), (ring.center - frame.origin()).dot(frame.axis()));
  };
  const Eigen::Vector2d first = section(basis.lower());
  for (const int span : basis.Spans()) {
    const double from = basis.knots()[span], length = basis.knots()[span + 1] - from;
    for (int k = 0; k <= 2 * basis.degree(); ++k) {
      const Eigen::Vector2d here = section(from + length * k / (2 * basis.degree()));
      if ((here - first).norm() > same) return false;
    }
  }
  return true;
}

}  // namespace

NurbsSurface MakeBilinear(const Eigen::Vector3d& p00,
                          const Eigen::Vector3d& p10,
                          const Eigen::Vector3d& p01,
                          const Eigen::Vector3d& p11) {
  Eigen::Matrix3Xd points(3, 4);
  points << p00, p01, p10, p11;
  RequireThat(points.allFinite(), "MakeBilinear", "a corner is not finite");
  return NurbsSurface(LineBasis(), LineBasis(), std::move(points));
}

NurbsSurface MakePlane(const Frame& frame, const Interval& x, const Interval& y) {
  RequireIncreasing("MakePlane", "x", x);
  RequireIncreasing("MakePlane", "y", y);
  return MakeBilinear(frame.At(x.lower, y.lower, 0),
                      frame.At(x.upper, y.lower, 0),
                      frame.At(x.lower, y.upper, 0),
                      frame.At(x.upper, y.upper, 0));
}

NurbsSurface MakeCylinder(const Frame& frame,
                          double radius,
                          const Interval& height,
                          const AngleRange& angles) {
  RequirePositive("MakeCylinder", "radius", radius);
  RequireIncreasing("MakeCylinder", "height", height);
  RequireSweep("MakeCylinder", "angles", angles);
  return Turned(StraightProfile(radius, radius, height), frame, angles);
}

NurbsSurface MakeCone(const Frame& frame,
                      double radius_lower,
                      double radius_upper,
                      const Interval& height,
                      const AngleRange& angles) {
  for (const auto& [name, radius] :
       {std::pair("radius_lower", radius_lower), std::pair("radius_upper", radius_upper)}) {
    RequireThat(radius >= 0 && std::isfinite(radius),
                "MakeCone",
                std::string(name) + " = " + NumberText(radius) + " is negative or not finite");
  }
  RequireThat(radius_lower + radius_upper > 0, "MakeCone", "both radii are zero");
  RequireIncreasing("MakeCone", "height", height);
  RequireSweep("MakeCone", "angles", angles);
  return Turned(StraightProfile(radius_lower, radius_upper, height), frame, angles);
}

NurbsSurface MakeSphere(const Frame& frame,
                        double radius,
                        const AngleRange& longitude,
                        const Interval& latitude) {
  constexpr double kPole = 1e-12;
  RequirePositive("MakeSphere", "radius", radius);
  RequireSweep("MakeSphere", "longitude", longitude);
  RequireIncreasing("MakeSphere", "latitude", latitude);
  RequireThat(latitude.lower >= -kHalfTurn / 2 - kPole && latitude.upper <= kHalfTurn / 2 + kPole,
              "MakeSphere",
              "latitude = " + IntervalText(latitude.lower, latitude.upper) +
                  " is not within [-pi/2, pi/2]");
  const double lower = latitude.lower <= -kHalfTurn / 2 + kPole ? -kHalfTurn / 2 : latitude.lower;
  const double upper = latitude.upper >= kHalfTurn / 2 - kPole ? kHalfTurn / 2 : latitude.upper;
  Profile profile = RoundProfile(0, radius, {lower, upper - lower});
  if (lower == -kHalfTurn / 2) profile.points.col(0) << 0, -radius;
  if (upper == kHalfTurn / 2) profile.points.rightCols<1>() << 0, radius;
  return Turned(profile, frame, longitude);
}

NurbsSurface MakeTorus(const Frame& frame,
                       double major,
                       double minor,
                       const AngleRange& round,
                       const AngleRange& tube) {
  RequirePositive("MakeTorus", "major", major);
  RequirePositive("MakeTorus", "minor", minor);
  RequireSweep("MakeTorus", "round", round);
  RequireSweep("MakeTorus", "tube", tube);
  return Turned(RoundProfile(major, minor, tube), frame, round);
}

NurbsSurface Revolve(const NurbsCurve<3>& profile, const Frame& frame, const AngleRange& angles) {
  RequireSweep("Revolve", "angles", angles);
  constexpr double kSlack = 1e-12;
  if (angles.sweep > kHalfTurn + kSlack) RefuseCrossings(profile, frame, "Revolve");
  const UnitArc arc(angles);
  const Eigen::Matrix3Xd& curve = profile.control_points();
  const double size = std::max(curve.cwiseAbs().maxCoeff(), frame.origin().cwiseAbs().maxCoeff());
  const double on_axis = 4 * std::numeric_limits<double>::epsilon() * size;
  const Eigen::Index around = arc.points.cols(), along = curve.cols();
  Eigen::Matrix3Xd points(3, around * along);
  Eigen::VectorXd weights(points.cols());
  bool turns = false;
  for (Eigen::Index j = 0; j < along; ++j) {
    const Ring ring = TorusSectionOf(curve.col(j), frame, on_axis);
    turns = turns || !ring.outward.isZero(0);
    for (Eigen::Index i = 0; i < around; ++i) {
      const Eigen::Vector2d at = arc.points.col(i);
      const bool unturned = at.x() == 1 && at.y() == 0 && !ring.outward.isZero(0);
      points.col(i * along + j) =
          unturned ? Eigen::Vector3d(curve.col(j))
                   : Eigen::Vector3d(ring.center + (at.x() * ring.outward + at.y() * ring.forward));
      weights[i * along + j] = arc.weights[i] * profile.weights()[j];
    }
  }
  RequireThat(
      turns, "Revolve", "the curve lies on the axis: move the axis, or the curve away from it");
  RequireThat(!GoesRound(profile, frame),
              "Revolve",
              "the curve is a point, or lies on a circle about the axis: the surface would have no "
              "area; turn it about another axis");
  return NurbsSurface(arc.basis, profile.basis(), std::move(points), std::move(weights));
}

}  // namespace batten
