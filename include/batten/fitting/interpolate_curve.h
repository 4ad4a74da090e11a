// SPDX-License-Identifier: MIT
// Global curve interpolation.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "batten/fitting/curve_parameterization.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten {

struct CurveInterpolationOptions {
  int degree = 3;  // 1 … 25
  CurveParameterization parameterization = CurveParameterization::kChord;
  // For kGiven: one a point, increasing; for a closed curve one more, where it is back at the
  // first.
  Eigen::VectorXd parameters = {};
  bool closed = false;  // goes on from the last point to the first, C^{p−1} everywhere
  // As many functions as there are points and derivatives (closed: different functions of a
  // periodic basis). Chosen when absent: means of p neighbouring parameters, uniform knots for
  // kUniversal, closed as KnotsAround (data_knots.h) has them.
  std::optional<SplineBasis> basis = std::nullopt;
};

// A prescribed derivative of the curve at one of its points.
template <int Dim>
struct PointDerivative {
  Eigen::Index point = 0;
  int order = 1;  // 1 … degree
  Eigen::Matrix<double, Dim, 1>
      value;  // data's units by the parameter's, to the power of the order
};

template <int Dim>
struct InterpolatedCurve {
  NurbsCurve<Dim> curve;
  Eigen::VectorXd
      parameters;  // one a point, in the curve's domain: there it goes through the point
};

// Interpolates all points (Dim × m) by a curve of the given degree, with the derivatives given at
// some or all of them. Domain: [0, 1], or that of the given parameters or basis. Meets its points
// to rounding times the condition of the equations, which grows with the degree and with the
// unevenness of the parameters; an open curve's ends exactly. Straight lines stay straight.
// O(m·p²). Throws std::invalid_argument, with a sentence for the user, where there are fewer points
// and derivatives than degree + 1 (closed: fewer than 3 points), neighbours lie in one place so
// that parameters do not increase, a given basis does not suit the parameters (Schoenberg–Whitney),
// or a derivative is given twice, at no point, or of an order the degree has not. [Piegl & Tiller
// 1997, A9.1, §9.2.2, §9.2.4; de Boor 1978, XIII]
template <int Dim>
InterpolatedCurve<Dim> InterpolateCurve(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                        const CurveInterpolationOptions& options = {},
                                        std::span<const PointDerivative<Dim>> derivatives = {});

enum class InterpolationEnd { kStart, kEnd };

// The first derivative at an end in the direction `tangent`, as fast as the parameters step from
// that end to its neighbour: for users who know only the direction. Throws std::invalid_argument if
// the direction has no length or parameters do not increase. [after Piegl & Tiller 1997, §9.2.2]
template <int Dim>
PointDerivative<Dim> EndTangent(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                const Eigen::VectorXd& parameters,
                                InterpolationEnd end,
                                const Eigen::Matrix<double, Dim, 1>& tangent);

extern template InterpolatedCurve<2> InterpolateCurve<2>(const Eigen::Matrix2Xd&,
                                                         const CurveInterpolationOptions&,
                                                         std::span<const PointDerivative<2>>);
extern template InterpolatedCurve<3> InterpolateCurve<3>(const Eigen::Matrix3Xd&,
                                                         const CurveInterpolationOptions&,
                                                         std::span<const PointDerivative<3>>);

}  // namespace batten
