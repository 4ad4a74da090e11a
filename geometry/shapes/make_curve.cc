// SPDX-License-Identifier: MIT
#include "batten/geometry/make_curve.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "geometry/numeric/construction_checks.h"
#include "geometry/shapes/unit_arc.h"

namespace batten {
using namespace internal;

template <int Dim>
NurbsCurve<Dim> MakeLine(const Eigen::Matrix<double, Dim, 1>& start,
                         const Eigen::Matrix<double, Dim, 1>& end) {
  RequireThat(start.allFinite() && end.allFinite(), "MakeLine", "an end is not finite");
  RequireThat(start != end, "MakeLine", "the ends are one point: give two that differ");
  typename NurbsCurve<Dim>::Points ends(Dim, 2);
  ends << start, end;
  return NurbsCurve<Dim>(SplineBasis(1, {0, 0, 1, 1}), std::move(ends));
}

namespace {

NurbsCurve<3> Placed(const UnitArc& arc, const Frame& frame, double radius_x, double radius_y) {
  Eigen::Matrix3Xd points(3, arc.points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    points.col(k) = frame.At(radius_x * arc.points(0, k), radius_y * arc.points(1, k), 0);
  }
  return NurbsCurve<3>(arc.basis, std::move(points), arc.weights);
}

}  // namespace

NurbsCurve<3> MakeEllipseArc(const Frame& frame,
                             double radius_x,
                             double radius_y,
                             const AngleRange& angles) {
  RequirePositive("MakeEllipseArc", "radius_x", radius_x);
  RequirePositive("MakeEllipseArc", "radius_y", radius_y);
  RequireSweep("MakeEllipseArc", "angles", angles);
  return Placed(UnitArc(angles), frame, radius_x, radius_y);
}

NurbsCurve<3> MakeArc(const Frame& frame, double radius, const AngleRange& angles, int pieces) {
  RequirePositive("MakeArc", "radius", radius);
  RequireSweep("MakeArc", "angles", angles);
  constexpr int kMost = 1000;
  constexpr double kHalfTurn = std::numbers::pi * (1 - 1e-6);  // its middle weight is not zero yet
  RequireThat(pieces >= 1 && pieces <= kMost,
              "MakeArc",
              "pieces = " + std::to_string(pieces) + " is not in [1, 1000]");
  RequireThat(
      angles.sweep / pieces <= kHalfTurn,
      "MakeArc",
      "pieces = " + std::to_string(pieces) +
          " makes pieces of 180 degrees or more, which have no positive weights; take more");
  return Placed(UnitArc(angles, pieces), frame, radius, radius);
}

NurbsCurve<3> MakeCircle(const Frame& frame, double radius, CircleForm form, double start) {
  if (form == CircleForm::kNinePoints) return MakeArc(frame, radius, {start});
  if (form == CircleForm::kSevenPoints) return MakeArc(frame, radius, {start}, 3);
  RequirePositive("MakeCircle", "radius", radius);
  RequireThat(std::isfinite(start), "MakeCircle", "start is not finite");
  const Eigen::Vector2d x = UnitVectorAt(start), y(-x[1], x[0]);
  const double along[] = {1, 1, -3, -3, 1, 1}, across[] = {0, 4, 2, -2, -4, 0};
  Eigen::Matrix3Xd points(3, 6);
  for (int k = 0; k < 6; ++k) {
    const Eigen::Vector2d unit = along[k] * x + across[k] * y;
    points.col(k) = frame.At(radius * unit[0], radius * unit[1], 0);
  }
  Eigen::VectorXd weights(6);
  weights << 5, 1, 1, 1, 1, 5;
  const double ends[] = {0, 1};
  return NurbsCurve<3>(SplineBasis::Clamped(5, ends), std::move(points), std::move(weights));
}

NurbsCurve<3> MakeArc(const Frame& frame, double radius, const AngleRange& angles) {
  RequirePositive("MakeArc", "radius", radius);
  RequireSweep("MakeArc", "angles", angles);
  return MakeEllipseArc(frame, radius, radius, angles);
}

NurbsCurve<2> MakeArc(const Eigen::Vector2d& center, double radius, const AngleRange& angles) {
  RequirePositive("MakeArc", "radius", radius);
  RequireThat(center.allFinite(), "MakeArc", "the centre is not finite");
  RequireSweep("MakeArc", "angles", angles);
  const UnitArc arc(angles);
  Eigen::Matrix2Xd points = radius * arc.points;
  points.colwise() += center;
  return NurbsCurve<2>(arc.basis, std::move(points), arc.weights);
}

template <int Dim>
NurbsCurve<Dim> MakeFlatArc(const Eigen::Matrix<double, Dim, 1>& point,
                            const Eigen::Matrix<double, Dim, 1>& outward,
                            const Eigen::Matrix<double, Dim, 1>& forward,
                            double curvature,
                            const AngleRange& angles) {
  RequirePositive("MakeFlatArc", "curvature", curvature);
  RequireSweep("MakeFlatArc", "angles", angles);
  const UnitArc arc(angles);
  typename NurbsCurve<Dim>::Points points(Dim, arc.points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double over = arc.less_one[k] / curvature, along = arc.points(1, k) / curvature;
    points.col(k) = point + (over * outward + along * forward);
  }
  return NurbsCurve<Dim>(arc.basis, std::move(points), arc.weights);
}

template NurbsCurve<2> MakeLine<2>(const Eigen::Vector2d&, const Eigen::Vector2d&);
template NurbsCurve<3> MakeLine<3>(const Eigen::Vector3d&, const Eigen::Vector3d&);
template NurbsCurve<2> MakeFlatArc<2>(const Eigen::Vector2d&,
                                      const Eigen::Vector2d&,
                                      const Eigen::Vector2d&,
                                      double,
                                      const AngleRange&);
template NurbsCurve<3> MakeFlatArc<3>(const Eigen::Vector3d&,
                                      const Eigen::Vector3d&,
                                      const Eigen::Vector3d&,
                                      double,
                                      const AngleRange&);

}  // namespace batten
