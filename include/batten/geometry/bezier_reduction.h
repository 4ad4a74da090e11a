// SPDX-License-Identifier: MIT
// Degree reduction of Bézier curves by one, by four rules.
#pragma once

#include <optional>

#include "batten/geometry/bezier_curve.h"

namespace batten {

// Which curve Q of degree n−1 stands for the curve P of degree n. Elevation would give
// P_i = (i/n) Q_{i−1} + (1 − i/n) Q_i for i = 0 … n: n+1 equations for n points.
//  kForward: the first n hold. All derivatives up to order n−1 agree at the start, and the
//    difference is (P_n − Q_{n−1}) t^n.
//  kBackward: the last n hold, the same at the end.
//  kLeastSquares: least Σ of the squared defects of all, which is also least ∫‖P − Q‖².
//  kLeastSquaresFixedEnds: the same with Q_0 = P_0 and Q_{n−1} = P_n.
enum class BezierReductionRule { kForward, kBackward, kLeastSquares, kLeastSquaresFixedEnds };

template <int Dim>
struct BezierReduction {
  BezierCurve<Dim> curve;
  double error;  // ‖Q(t) − P(t)‖ is nowhere greater, and comes within 1 % of it: DeviationBound
};

// The curve of one degree less, in homogeneous coordinates if it is rational (least squares then
// with the equations divided by the given weights). An elevated curve is found again: to rounding
// by least squares; by the one-sided rules to about 2^n roundings, which add up from point to
// point. None where a weight of the result would not be positive. Throws std::invalid_argument when
// the degree is less than one, or two with fixed ends. O(n³). [Piegl & Tiller 1997, eq. 5.41–5.46;
// Lutterkort, Peters & Reif 1999]
template <int Dim>
std::optional<BezierReduction<Dim>> Reduced(const BezierCurve<Dim>& curve,
                                            BezierReductionRule rule);

}  // namespace batten
