// SPDX-License-Identifier: MIT
#include "batten/geometry/make_curve.h"

#include <cmath>
#include <utility>

#include "geometry/numeric/construction_checks.h"
#include "geometry/shapes/unit_arc.h"

namespace batten {
using namespace internal;

template <int Dim>
NurbsCurve<Dim> MakeLine(const Eigen::Matrix<double, Dim, 1>& start,
                         const Eigen::Matrix<double, Dim, 1>& end) {
  RequireThat(start.allFinite() && end.allFinite(), "MakeLine", "an end is not finite");
  RequireThat(start != end, "MakeLine", "the ends are one point");
  typename NurbsCurve<Dim>::Points ends(Dim, 2);
  ends << start, end;
  return NurbsCurve<Dim>(SplineBasis(1, {0, 0, 1, 1}), std::move(ends));
}

NurbsCurve<3> MakeEllipseArc(const Frame& frame,
                             double radius_x,
                             double radius_y,
                             const AngleRange& angles) {
  RequirePositive("MakeEllipseArc", "radius_x", radius_x);
  RequirePositive("MakeEllipseArc", "radius_y", radius_y);
  RequireSweep("MakeEllipseArc", "angles", angles);
  const UnitArc arc(angles);
  Eigen::Matrix3Xd points(3, arc.points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    points.col(k) = frame.At(radius_x * arc.points(0, k), radius_y * arc.points(1, k), 0);
  }
  return NurbsCurve<3>(arc.basis, std::move(points), arc.weights);
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
