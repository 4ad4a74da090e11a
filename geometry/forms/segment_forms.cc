// SPDX-License-Identifier: MIT
#include "batten/geometry/segment_forms.h"

#include <string>

#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

template <int Dim>
void RequirePolynomial(const BezierCurve<Dim>& curve, int degree, const char* function) {
  RequireThat(curve.degree() == degree && !curve.rational(),
              function,
              "the curve must be of degree " + std::to_string(degree) + " without weights, not " +
                  (curve.rational() ? "rational" : "of degree " + std::to_string(curve.degree())));
}

}  // namespace

template <int Dim>
BezierCurve<Dim> ToBezier(const CubicHermite<Dim>& s) {
  Eigen::Matrix<double, Dim, Eigen::Dynamic> points(Dim, 4);
  points << s.start, s.start + s.start_derivative / 3, s.end - s.end_derivative / 3, s.end;
  return BezierCurve<Dim>(std::move(points));
}

template <int Dim>
BezierCurve<Dim> ToBezier(const QuinticHermite<Dim>& s) {
  Eigen::Matrix<double, Dim, Eigen::Dynamic> points(Dim, 6);
  points << s.start, s.start + s.start_derivative / 5,
      s.start + 2 * s.start_derivative / 5 + s.start_second / 20,
      s.end - 2 * s.end_derivative / 5 + s.end_second / 20, s.end - s.end_derivative / 5, s.end;
  return BezierCurve<Dim>(std::move(points));
}

template <int Dim>
BezierCurve<Dim> ToBezier(const UniformCubicSegment<Dim>& s) {
  const auto& d = s.control_points;
  Eigen::Matrix<double, Dim, Eigen::Dynamic> points(Dim, 4);
  points << (d.col(0) + 4 * d.col(1) + d.col(2)) / 6, (2 * d.col(1) + d.col(2)) / 3,
      (d.col(1) + 2 * d.col(2)) / 3, (d.col(1) + 4 * d.col(2) + d.col(3)) / 6;
  return BezierCurve<Dim>(std::move(points));
}

template <int Dim>
CubicHermite<Dim> CubicHermiteOf(const BezierCurve<Dim>& curve) {
  RequirePolynomial(curve, 3, "CubicHermiteOf");
  const auto& b = curve.control_points();
  return {b.col(0), 3 * (b.col(1) - b.col(0)), b.col(3), 3 * (b.col(3) - b.col(2))};
}

template <int Dim>
QuinticHermite<Dim> QuinticHermiteOf(const BezierCurve<Dim>& curve) {
  RequirePolynomial(curve, 5, "QuinticHermiteOf");
  const auto& b = curve.control_points();
  return {b.col(0),
          5 * (b.col(1) - b.col(0)),
          20 * ((b.col(2) - b.col(1)) - (b.col(1) - b.col(0))),
          b.col(5),
          5 * (b.col(5) - b.col(4)),
          20 * ((b.col(5) - b.col(4)) - (b.col(4) - b.col(3)))};
}

template <int Dim>
UniformCubicSegment<Dim> UniformCubicSegmentOf(const BezierCurve<Dim>& curve) {
  RequirePolynomial(curve, 3, "UniformCubicSegmentOf");
  const auto& b = curve.control_points();
  UniformCubicSegment<Dim> segment;
  segment.control_points << 6 * b.col(0) - 7 * b.col(1) + 2 * b.col(2), 2 * b.col(1) - b.col(2),
      2 * b.col(2) - b.col(1), 6 * b.col(3) - 7 * b.col(2) + 2 * b.col(1);
  return segment;
}

#define BATTEN_SEGMENT_FORMS(Dim)                                         \
  template BezierCurve<Dim> ToBezier(const CubicHermite<Dim>&);           \
  template BezierCurve<Dim> ToBezier(const QuinticHermite<Dim>&);         \
  template BezierCurve<Dim> ToBezier(const UniformCubicSegment<Dim>&);    \
  template CubicHermite<Dim> CubicHermiteOf(const BezierCurve<Dim>&);     \
  template QuinticHermite<Dim> QuinticHermiteOf(const BezierCurve<Dim>&); \
  template UniformCubicSegment<Dim> UniformCubicSegmentOf(const BezierCurve<Dim>&);
BATTEN_SEGMENT_FORMS(2)
BATTEN_SEGMENT_FORMS(3)
#undef BATTEN_SEGMENT_FORMS

}  // namespace batten
