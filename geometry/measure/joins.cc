// SPDX-License-Identifier: MIT
#include "batten/geometry/joins.h"

#include <array>
#include <optional>
#include <utility>

#include "batten/geometry/curvature.h"
#include "geometry/bezier/curve_frame.h"
#include "geometry/measure/join_tolerances.h"
#include "geometry/numeric/polygon.h"

namespace batten {
using namespace internal;
namespace {

template <int Dim>
Eigen::Vector3d InSpace(const Eigen::Matrix<double, Dim, 1>& v) {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  result.template head<Dim>() = v;
  return result;
}

// The end of a curve, run through in one sense.
struct CurveEnd {
  double at;
  Eigen::Vector3d point, first, second;  // derivatives in that sense
  std::optional<Eigen::Vector3d> tangent, curvature;
  double steepness;
};

// `along` is −1 where the parameter falls.
template <int Dim>
CurveEnd EndOf(const NurbsCurve<Dim>& curve, bool upper, double along) {
  CurveEnd end;
  end.at = upper ? curve.basis().upper() : curve.basis().lower();
  const auto derivatives = curve.Derivatives(end.at, 2);
  end.point = InSpace<Dim>(derivatives.col(0));
  end.first = along * InSpace<Dim>(derivatives.col(1));
  end.second = InSpace<Dim>(derivatives.col(2));
  if (const auto tangent = TangentAt(curve, end.at)) end.tangent = along * InSpace<Dim>(*tangent);
  if (const auto curvature = CurvatureAt(curve, end.at)) {
    end.curvature = Eigen::Vector3d::Zero();
    const auto frame = FrameAt(curve, end.at);
    if (frame) end.curvature = Eigen::Vector3d(curvature->curvature * frame->normal);
  }
  end.steepness = Steepness(curve.basis(), end.at);
  return end;
}

CurveJoin Measured(const CurveEnd& first, const CurveEnd& second, const JoinScale& scale) {
  CurveJoin join;
  join.at = {first.at, second.at};
  join.position_gap = (first.point - second.point).norm();
  if (first.tangent && second.tangent) {
    join.angle_gap = AngleBetween(*first.tangent, *second.tangent);
  }
  double curvature = 0;
  if (first.curvature && second.curvature) {
    join.curvature_gap = (*first.curvature - *second.curvature).norm();
    curvature = std::max(first.curvature->norm(), second.curvature->norm());
  }
  if (!(join.position_gap <= scale.position())) return join;
  const double speed = std::max(first.first.norm(), second.first.norm());
  const double least = scale.size() > 0 ? speed * speed / scale.size() : 0;
  join.parametric = join.geometric = 0;
  const double steepness = std::max(first.steepness, second.steepness);
  if (scale.Equal(first.first, second.first, 0, scale.rounding() * steepness)) {
    join.parametric = 1;
    const double rounding = scale.rounding() * steepness * steepness;
    if (scale.Equal(first.second, second.second, least, rounding)) join.parametric = 2;
  }
  if (join.angle_gap && scale.Smooth(*join.angle_gap)) {
    join.geometric = 1;
    if (join.curvature_gap && scale.EquallyCurved(*join.curvature_gap, curvature)) {
      join.geometric = 2;
    }
  }
  return join;
}

}  // namespace

template <int Dim>
CurveJoin TestJoin(const NurbsCurve<Dim>& first,
                   const NurbsCurve<Dim>& second,
                   const JoinOptions& options) {
  const JoinScale scale(first, second, options, "TestJoin");
  const auto gap = [&](bool upper_1, bool upper_2) {
    const SplineBasis &a = first.basis(), &b = second.basis();
    return (first.At(upper_1 ? a.upper() : a.lower()) - second.At(upper_2 ? b.upper() : b.lower()))
        .norm();
  };
  bool upper[2] = {true, false};
  double least = gap(true, false);
  for (const auto& [upper_1, upper_2] : {std::pair{true, true}, {false, false}, {false, true}}) {
    const double here = gap(upper_1, upper_2);
    if (!(here < least - scale.position())) continue;
    least = here;
    upper[0] = upper_1;
    upper[1] = upper_2;
  }
  return Measured(
      EndOf(first, upper[0], upper[0] ? 1 : -1), EndOf(second, upper[1], upper[1] ? -1 : 1), scale);
}

template <int Dim>
CurveJoin TestSeam(const NurbsCurve<Dim>& curve, const JoinOptions& options) {
  const JoinScale scale(curve, curve, options, "TestSeam");
  return Measured(EndOf(curve, true, 1), EndOf(curve, false, 1), scale);
}

template CurveJoin TestJoin(const NurbsCurve<2>&, const NurbsCurve<2>&, const JoinOptions&);
template CurveJoin TestJoin(const NurbsCurve<3>&, const NurbsCurve<3>&, const JoinOptions&);
template CurveJoin TestSeam(const NurbsCurve<2>&, const JoinOptions&);
template CurveJoin TestSeam(const NurbsCurve<3>&, const JoinOptions&);

}  // namespace batten
