// SPDX-License-Identifier: MIT
#include "fitting/constraints/polynomial_curve.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "batten/geometry/remove_knots.h"
#include "geometry/numeric/number_text.h"

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
  const auto parts = static_cast<Eigen::Index>(breaks.size()) - 1;
  Eigen::Matrix3Xd points(3, 3 * parts + 1);
  std::vector<double> knots{breaks.front()};
  for (Eigen::Index i = 0; i < parts; ++i) {
    const double a = breaks[static_cast<size_t>(i)], b = breaks[static_cast<size_t>(i) + 1];
    points.col(3 * i) = curve.At(a);
    points.col(3 * i + 1) = points.col(3 * i) + (b - a) / 3 * curve.JetAt(a).first;
    points.col(3 * i + 2) = curve.At(b) - (b - a) / 3 * EndSlope(curve, a, b);
    knots.insert(knots.end(), 3, a);
  }
  points.col(3 * parts) = curve.At(breaks.back());
  knots.insert(knots.end(), 4, breaks.back());
  return NurbsCurve<3>(SplineBasis(3, knots), std::move(points));
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

std::vector<double> CutSpans(const SplineBasis& basis, int parts) {
  std::vector<double> spans;
  for (const double knot : basis.knots()) {
    if (knot < basis.lower() || knot > basis.upper()) continue;
    if (spans.empty() || knot > spans.back()) spans.push_back(knot);
  }
  std::vector<double> breaks{spans.front()};
  for (size_t i = 1; i < spans.size(); ++i) {
    const double step = (spans[i] - spans[i - 1]) / parts;
    for (int k = 1; k < parts; ++k) breaks.push_back(spans[i - 1] + k * step);
    breaks.push_back(spans[i]);
  }
  return breaks;
}

NurbsCurve<3> PolynomialCurve(const NurbsCurve<3>& curve, double tolerance) {
  for (int parts = 1; parts <= kMostParts; parts *= 2) {
    const std::vector<double> breaks = CutSpans(curve.basis(), parts);
    NurbsCurve<3> cubics = Cubics(curve, breaks);
    if (Deviation(cubics, curve, breaks) > tolerance) continue;
    // One of the three knots at a break goes where the slopes of both sides agree.
    for (size_t i = 1; i + 1 < breaks.size(); ++i) {
      const double size = (cubics.control_points().rowwise().maxCoeff() -
                           cubics.control_points().rowwise().minCoeff())
                              .norm();
      cubics = RemoveKnot(cubics, breaks[i], 1, kCurveRounding * size + tolerance / 100).shape;
    }
    return cubics;
  }
  throw std::invalid_argument("PolynomialCurve: no cubics of " + std::to_string(kMostParts) +
                              " parts a span are within " + NumberText(tolerance));
}

}  // namespace batten::internal
