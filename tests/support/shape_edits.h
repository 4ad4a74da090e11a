// SPDX-License-Identifier: MIT
// Small things that tests of edited shapes share.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "refusal.h"

namespace batten::internal {

// 2^-52, the unit of rounding bounds.
inline constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon();

// Coordinate scales at which bounds are tested.
inline constexpr double kCoordinateScales[] = {1e-9, 1, 1e9};

// The shape with its coordinates multiplied.
template <int Dim>
NurbsCurve<Dim> Enlarged(const NurbsCurve<Dim>& curve, double factor) {
  return NurbsCurve<Dim>(curve.basis(), factor * curve.control_points(), curve.weights());
}
inline NurbsSurface Enlarged(const NurbsSurface& surface, double factor) {
  return NurbsSurface(
      surface.basis_u(), surface.basis_v(), factor * surface.control_points(), surface.weights());
}

// The greater of the length of the domain and its ends: what rounding of parameters is relative to.
inline double DomainExtent(const SplineBasis& basis) {
  return std::max(
      {basis.upper() - basis.lower(), std::abs(basis.lower()), std::abs(basis.upper())});
}

// The length of the shortest span of the domain.
inline double ShortestSpan(const SplineBasis& basis) {
  double shortest = basis.upper() - basis.lower();
  for (const int span : basis.Spans()) {
    shortest = std::min(shortest, basis.knots()[span + 1] - basis.knots()[span]);
  }
  return shortest;
}

// The greatest length of the k-th derivative, over samples of every span and both sides of knots.
template <int Dim>
double GreatestDerivative(const NurbsCurve<Dim>& curve, int k) {
  const SplineBasis& basis = curve.basis();
  double greatest = 0;
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    for (int sample = 0; sample <= 16; ++sample) {
      // Nearly up to the ends of the span, where weights of very different size show.
      const double t = (1 - std::cos(std::numbers::pi * sample / 16)) / 2;
      const double u = std::min(a + (b - a) * t, b - 1e-9 * (b - a));
      greatest = std::max(greatest, curve.Derivatives(u, k).col(k).norm());
    }
  }
  return greatest;
}

// How different the weights are.
inline double WeightRatio(const Eigen::VectorXd& weights) {
  return weights.maxCoeff() / weights.minCoeff();
}

}  // namespace batten::internal
