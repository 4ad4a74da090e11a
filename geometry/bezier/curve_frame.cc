// SPDX-License-Identifier: MIT
#include "geometry/bezier/curve_frame.h"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "batten/geometry/curvature.h"
#include "geometry/bezier/limit_series.h"

namespace batten::internal {
namespace {

constexpr double kSuspicious = 1e-9;  // a derivative this small may be nothing but rounding
constexpr double kNearEnd = 1e-3;
constexpr int kOrder = 12;

// C′ = τ^m D(τ) to one side of a parameter; side = −1 where that is to the left.
struct OneSidedDirection {
  VectorSeries D;
  int m;
  double side;
};

std::optional<OneSidedDirection> DirectionAt(const CurvePiece& piece, double t) {
  const bool backward = t == 1;
  const VectorSeries slope = Derivative(TaylorSeries(piece, t, kOrder, backward));
  const auto m = LeadingOrder(slope);
  if (!m) return std::nullopt;
  return OneSidedDirection{Shifted(slope, *m), *m, backward ? -1.0 : 1.0};
}

template <int Dim>
std::optional<OneSidedDirection> DirectionAt(const NurbsCurve<Dim>& curve, double u) {
  u = curve.basis().Clamp(u);
  const int span = curve.basis().Span(u);
  const std::vector<double>& U = curve.basis().knots();
  const double t = (u - U[span]) / (U[span + 1] - U[span]);
  const CurvePiece piece = AboutEnd(curve, span, t < 0.5 ? 0 : 1);
  auto direction = DirectionAt(piece, t);
  if (!direction || direction->m == 0) return direction;
  for (const double end : {0.0, 1.0}) {
    if (t == end || std::abs(t - end) > kNearEnd) continue;
    if (auto limit = DirectionAt(piece, end); limit && limit->m > 0) return limit;
  }
  return direction;
}

template <int Dim>
struct SpaceDerivatives {
  SpaceDerivatives(const NurbsCurve<Dim>& curve, double u) {
    columns.template topRows<Dim>() = curve.Derivatives(u, 3);
    width = curve.basis().upper() - curve.basis().lower();
  }
  Eigen::Vector3d operator[](int k) const { return columns.col(k); }

  // Whether C′, and with `bent` C′ × C″, are certainly more than rounding.
  bool Regular(bool bent) const {
    const double first = columns.col(1).norm(), second = columns.col(2).norm();
    const double third = columns.col(3).norm();
    if (!(first > kSuspicious * (second + third * width) * width)) return false;
    const double bend = columns.col(1).cross(columns.col(2)).norm();
    return !bent || bend > kSuspicious * first * (second + third * width);
  }

  Eigen::Matrix<double, 3, 4> columns = Eigen::Matrix<double, 3, 4>::Zero();
  double width;
};

// Binormal and curvature of C′ = τ^m D(τ): D × D′ begins with bend[j] τ^j.
struct Bend {
  VectorSeries series;
  std::optional<int> order;
};
Bend BendOf(const OneSidedDirection& direction) {
  VectorSeries series = Cross(direction.D, Derivative(direction.D));
  const auto order = LeadingOrder(series);
  return {std::move(series), order};
}

std::optional<CurveCurvature> LimitCurvature(const OneSidedDirection& direction) {
  const Bend bend = BendOf(direction);
  if (!bend.order) return CurveCurvature{0, 0};
  const int m = direction.m, j = *bend.order;
  if (j < m) return std::nullopt;
  CurveCurvature result{0, 0};
  if (j == m) result.curvature = bend.series[j].norm() / std::pow(direction.D[0].norm(), 3);
  const Series volume = Dot(bend.series, Derivative(Derivative(direction.D)));
  if (LeadingOrder(volume) == m + 2 * j) {
    result.torsion = volume[m + 2 * j].value / bend.series[j].squaredNorm();
  }
  return result;
}

}  // namespace

template <int Dim>
std::optional<Eigen::Matrix<double, Dim, 1>> TangentAt(const NurbsCurve<Dim>& curve, double u) {
  const SpaceDerivatives<Dim> C(curve, u);
  if (C.Regular(false)) return C[1].normalized().template head<Dim>();
  const auto direction = DirectionAt(curve, u);
  if (!direction) return std::nullopt;
  return (direction->side * direction->D[0].normalized()).template head<Dim>();
}

template <int Dim>
std::optional<CurveFrame> FrameAt(const NurbsCurve<Dim>& curve, double u) {
  const SpaceDerivatives<Dim> C(curve, u);
  CurveFrame frame;
  if (C.Regular(true)) {
    frame.tangent = C[1].normalized();
    frame.binormal = C[1].cross(C[2]).normalized();
  } else {
    const auto direction = DirectionAt(curve, u);
    if (!direction) return std::nullopt;
    const Bend bend = BendOf(*direction);
    if (!bend.order) return std::nullopt;
    // Backward both C′ and C′ × C″ change sign.
    frame.tangent = direction->side * direction->D[0].normalized();
    frame.binormal = direction->side * bend.series[*bend.order].normalized();
  }
  frame.normal = frame.binormal.cross(frame.tangent);
  return frame;
}

std::optional<double> SignedCurvatureAt(const NurbsCurve<2>& curve, double u) {
  const auto curvature = CurvatureAt(curve, u);
  if (!curvature) return std::nullopt;
  const auto frame = FrameAt(curve, u);
  return frame && frame->binormal.z() < 0 ? -curvature->curvature : curvature->curvature;
}

template std::optional<Eigen::Vector2d> TangentAt(const NurbsCurve<2>&, double);
template std::optional<Eigen::Vector3d> TangentAt(const NurbsCurve<3>&, double);
template std::optional<CurveFrame> FrameAt(const NurbsCurve<2>&, double);
template std::optional<CurveFrame> FrameAt(const NurbsCurve<3>&, double);

}  // namespace batten::internal

namespace batten {
using namespace internal;

template <int Dim>
std::optional<CurveCurvature> CurvatureAt(const NurbsCurve<Dim>& curve, double u) {
  const SpaceDerivatives<Dim> C(curve, u);
  if (C.Regular(true)) return CurvatureOf(C[1], C[2], C[3]);
  const auto direction = DirectionAt(curve, u);
  return direction ? LimitCurvature(*direction) : std::nullopt;
}

template std::optional<CurveCurvature> CurvatureAt(const NurbsCurve<2>&, double);
template std::optional<CurveCurvature> CurvatureAt(const NurbsCurve<3>&, double);

}  // namespace batten
