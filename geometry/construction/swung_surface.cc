// SPDX-License-Identifier: MIT
#include "batten/geometry/swung_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "geometry/construction/curve_closure.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/shapes/axis_crossings.h"

namespace batten {
using namespace internal;
namespace {

// The net of all pairs, with the products of weights. `make` gives the point of two control points.
template <typename Make>
NurbsSurface OfPairs(const NurbsCurve<3>& along_u, const NurbsCurve<3>& along_v, const Make& make) {
  const Eigen::Index m = along_u.control_points().cols(), n = along_v.control_points().cols();
  Eigen::Matrix3Xd points(3, m * n);
  Eigen::VectorXd weights(m * n);
  for (Eigen::Index i = 0; i < m; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      points.col(i * n + j) =
          make(along_u.control_points().col(i), along_v.control_points().col(j));
      weights[i * n + j] = along_u.weights()[i] * along_v.weights()[j];
    }
  }
  return NurbsSurface(along_u.basis(), along_v.basis(), std::move(points), std::move(weights));
}

// The curve in the frame's coordinates, of which the one at `row` is to be zero.
NurbsCurve<3> InPlane(const NurbsCurve<3>& curve, const Frame& frame, int row, const char* name) {
  constexpr double kFlat = 1e-9;  // of the size
  Eigen::Matrix3d axes;
  axes << frame.x(), frame.y(), frame.axis();
  Eigen::Matrix3Xd points = axes.transpose() * (curve.control_points().colwise() - frame.origin());
  const double off = points.row(row).cwiseAbs().maxCoeff();
  const double size =
      std::max(points.cwiseAbs().maxCoeff(), curve.control_points().cwiseAbs().maxCoeff());
  RequireThat(off <= kFlat * size,
              "Swing",
              std::string("the ") + name + " leaves the plane of the x axis and " +
                  (row == 2 ? "the y axis" : "the axis") + " by " + RoundedText(off) +
                  "; at most 1e-9 of its size, " + RoundedText(kFlat * size) + ", is allowed");
  points.row(row).setZero();
  return NurbsCurve<3>(curve.basis(), std::move(points), curve.weights());
}

// How far round the origin the plane curve goes, in radians, as its samples tell.
double TurnOf(const NurbsCurve<3>& around) {
  constexpr int kSamples = 32;  // a span
  const SplineBasis& basis = around.basis();
  Eigen::Vector3d last = around.At(basis.lower());
  double angle = 0, least = 0, most = 0;
  for (const int span : basis.Spans()) {
    const double from = basis.knots()[span], length = basis.knots()[span + 1] - from;
    for (int k = 1; k <= kSamples; ++k) {
      const Eigen::Vector3d point = around.At(from + length * k / kSamples);
      angle += std::atan2(last.x() * point.y() - last.y() * point.x(), last.dot(point));
      least = std::min(least, angle);
      most = std::max(most, angle);
      last = point;
    }
  }
  return most - least;
}

}  // namespace

NurbsSurface SweepTranslational(const NurbsCurve<3>& profile, const NurbsCurve<3>& trajectory) {
  RequireThat(!IsPoint(trajectory), "SweepTranslational", "the trajectory is a point");
  RequireThat(!IsPoint(profile), "SweepTranslational", "the profile is a point");
  const Eigen::Vector3d start = trajectory.At(trajectory.basis().lower());
  NurbsSurface swept =
      OfPairs(profile, trajectory, [&](const Eigen::Vector3d& c, const Eigen::Vector3d& t) {
        return Eigen::Vector3d(c + (t - start));
      });
  RequireArea(swept, "SweepTranslational");
  return swept;
}

NurbsSurface Swing(const NurbsCurve<3>& profile,
                   const NurbsCurve<3>& trajectory,
                   const Frame& frame,
                   double scale) {
  RequireThat(std::isfinite(scale) && scale != 0,
              "Swing",
              "scale = " + NumberText(scale) + " is zero or not finite");
  const NurbsCurve<3> meridian = InPlane(profile, frame, 1, "profile");
  const NurbsCurve<3> around = InPlane(trajectory, frame, 2, "trajectory");
  RequireThat(!meridian.control_points().row(0).isZero(0),
              "Swing",
              "the profile lies on the axis: move the axis, or the profile away from it");
  RequireThat(!IsPoint(around), "Swing", "the trajectory is a point");
  constexpr double kHalfTurn = std::numbers::pi, kSlack = 1e-9;
  if (TurnOf(around) > kHalfTurn + kSlack) RefuseCrossings(profile, frame, "Swing");
  return OfPairs(around, meridian, [&](const Eigen::Vector3d& t, const Eigen::Vector3d& p) {
    return frame.At(scale * p.x() * t.x(), scale * p.x() * t.y(), p.z());
  });
}

}  // namespace batten
