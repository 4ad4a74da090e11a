// SPDX-License-Identifier: MIT
#include "fitting/constraints/polynomial_curve.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "batten/geometry/remove_knots.h"
#include "geometry/bezier/cubic_chain.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/number_text.h"
#include "geometry/nurbs/span_breaks.h"

namespace batten::internal {
namespace {

constexpr int kMostParts = 4096;
constexpr double kCurveRounding = 1e-13;  // of the size

// The derivative at the end of [a, b] from inside.
Eigen::Vector3d EndSlope(const NurbsCurve<3>& curve, double a, double b) {
  const double just_inside = b - 1e-9 * (b - a);
  const CurveJet<3> jet = curve.JetAt(b < curve.basis().upper() ? just_inside : b);
  return jet.first + (b < curve.basis().upper() ? 1e-9 * (b - a) : 0.0) * jet.second;
}

NurbsCurve<3> Cubics(const NurbsCurve<3>& curve, const std::vector<double>& breaks) {
  CubicChain<3> chain;
  for (size_t i = 1; i < breaks.size(); ++i) {
    const double a = breaks[i - 1], b = breaks[i];
    const Eigen::Vector3d start = curve.At(a), end = curve.At(b);
    Eigen::Matrix<double, 3, 4> cubic;
    cubic << start, start + (b - a) / 3 * curve.JetAt(a).first,
        end - (b - a) / 3 * EndSlope(curve, a, b), end;
    chain.Add(cubic, a, b, 3);
  }
  return chain.Take();
}

double Deviation(const NurbsCurve<3>& a,
                 const NurbsCurve<3>& b,
                 const std::vector<double>& breaks) {
  double most = 0;
  for (size_t i = 1; i < breaks.size(); ++i) {
    for (const double share : {0.25, 0.5, 0.75}) {
      const double u = breaks[i - 1] + share * (breaks[i] - breaks[i - 1]);
      most = std::max(most, (a.At(u) - b.At(u)).norm());
    }
  }
  return most;
}

}  // namespace

NurbsCurve<3> PolynomialCurve(const NurbsCurve<3>& curve, double tolerance) {
  for (int parts = 1; parts <= kMostParts; parts *= 2) {
    const std::vector<double> breaks = BreaksIn(curve.basis(), parts);
    NurbsCurve<3> cubics = Cubics(curve, breaks);
    if (Deviation(cubics, curve, breaks) > tolerance) continue;
    // One of the three knots at a break goes where the slopes of both sides agree.
    for (size_t i = 1; i + 1 < breaks.size(); ++i) {
      const double size = BoxDiagonal(cubics.control_points());
      cubics = RemoveKnot(cubics, breaks[i], 1, kCurveRounding * size + tolerance / 100).shape;
    }
    return cubics;
  }
  throw std::invalid_argument("PolynomialCurve: no cubics of " + std::to_string(kMostParts) +
                              " parts a span are within " + NumberText(tolerance));
}

}  // namespace batten::internal
