// SPDX-License-Identifier: MIT
// Whether two shapes are the same, point by point and derivative by derivative, to rounding.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "random_splines.h"
#include "shape_edits.h"

namespace batten::internal {

inline constexpr int kComparedPlaces = 24;

// What rounding may do to a k-th derivative, up to a small factor, where a point is right to
// `point`: every derivative of the homogeneous form is a difference that gains 2p over the length
// of the span, and Leibniz' rule for the quotient k times the ratio of the weights that act.
inline double DerivativeRounding(double point, int order, double gain, double weight_ratio) {
  double bound = point;
  for (int k = 1; k <= order; ++k) bound *= k * gain * weight_ratio;
  return bound;
}

// 2p over the length of the span at u, of the shorter one of both bases.
inline double GainAt(const SplineBasis& a, const SplineBasis& b, double u, double v) {
  const auto gain = [](const SplineBasis& basis, double at) {
    const int span = basis.Span(basis.Clamp(at));
    return 2 * basis.degree() / (basis.knots()[span + 1] - basis.knots()[span]);
  };
  return std::max(gain(a, u), gain(b, v));
}

template <typename Shape>
double WeightRatio(const Shape& shape) {
  return shape.rational() ? shape.weights().maxCoeff() / shape.weights().minCoeff() : 1;
}

// `got` at v is `expected` at u: points to `units` units of rounding of the largest coordinate per
// degree, derivatives to order 3 by what that allows.
template <int Dim>
void ExpectSameAt(const NurbsCurve<Dim>& expected,
                  double u,
                  const NurbsCurve<Dim>& got,
                  double v,
                  double units = 64,
                  bool reversed = false) {
  const int p = expected.basis().degree();
  const double bound = units * (p + 1) * kUnitRoundoff * ExtentOf(expected);
  EXPECT_LE((expected.At(u) - got.At(v)).cwiseAbs().maxCoeff(), bound) << "at " << u;
  constexpr int kOrder = 3;
  const auto a = expected.Derivatives(u, kOrder), b = got.Derivatives(v, kOrder);
  const double ratio = std::max(WeightRatio(expected), WeightRatio(got));
  const double gain = GainAt(expected.basis(), got.basis(), u, v);
  for (int k = 0; k <= kOrder; ++k) {
    const double sign = reversed && k % 2 == 1 ? -1 : 1;
    EXPECT_LE((a.col(k) - sign * b.col(k)).cwiseAbs().maxCoeff(),
              DerivativeRounding(bound, k, gain, ratio))
        << "derivative " << k << " at " << u;
  }
}

// The curves agree over the domain of `got`.
template <int Dim>
void ExpectSame(const NurbsCurve<Dim>& expected,
                const NurbsCurve<Dim>& got,
                RandomSplines& random,
                double units = 64) {
  for (int k = 0; k < kComparedPlaces; ++k) {
    const double u = random.Parameter(got.basis());
    // At its upper end a piece is seen from the left, the whole from the right.
    if (u == got.basis().upper() && u < expected.basis().upper()) {
      const double bound = units * (got.basis().degree() + 1) * kUnitRoundoff * ExtentOf(expected);
      EXPECT_LE((expected.At(u) - got.At(u)).cwiseAbs().maxCoeff(), bound);
      continue;
    }
    ExpectSameAt(expected, u, got, u, units);
  }
}

// The surfaces agree over the domain of `got`, partial derivatives to order 2 too.
inline void ExpectSame(const NurbsSurface& expected,
                       const NurbsSurface& got,
                       RandomSplines& random,
                       double units = 64) {
  const int p = expected.basis_u().degree(), q = expected.basis_v().degree();
  const double bound = units * (p + q + 1) * kUnitRoundoff * ExtentOf(expected);
  const double ratio = std::max(WeightRatio(expected), WeightRatio(got));
  for (int k = 0; k < kComparedPlaces; ++k) {
    const double u = random.Parameter(got.basis_u()), v = random.Parameter(got.basis_v());
    EXPECT_LE((expected.At(u, v) - got.At(u, v)).cwiseAbs().maxCoeff(), bound) << u << ", " << v;
    const bool at_end = (u == got.basis_u().upper() && u < expected.basis_u().upper()) ||
                        (v == got.basis_v().upper() && v < expected.basis_v().upper());
    if (at_end) continue;
    constexpr int kOrder = 2;
    const SurfaceDerivatives a = expected.Derivatives(u, v, kOrder);
    const SurfaceDerivatives b = got.Derivatives(u, v, kOrder);
    const double gain = std::max(GainAt(expected.basis_u(), got.basis_u(), u, u),
                                 GainAt(expected.basis_v(), got.basis_v(), v, v));
    for (int i = 0; i <= kOrder; ++i) {
      for (int j = 0; i + j <= kOrder; ++j) {
        EXPECT_LE((a(i, j) - b(i, j)).cwiseAbs().maxCoeff(),
                  DerivativeRounding(bound, i + j, gain, ratio))
            << "derivative " << i << ", " << j << " at " << u << ", " << v;
      }
    }
  }
}

}  // namespace batten::internal
