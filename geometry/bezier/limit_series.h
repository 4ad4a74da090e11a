// SPDX-License-Identifier: MIT
// Power series of curves and surfaces about a point, every coefficient with a bound of its
// rounding: what decides whether a derivative vanishes, and what a quotient tends to where its
// numerator and denominator vanish together. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "geometry/bezier/spline_pieces.h"

namespace batten::internal {

// A number and a bound of how far rounding may have moved it. [Wilkinson 1963, §1; Higham 2002,
// §3.3, running error analysis]
struct Rounded {
  double value = 0, error = 0;

  // Different from zero beyond doubt, and known to a per cent or better.
  bool significant() const { return std::abs(value) > 64 * error; }
};

inline double RoundingOf(double value) {
  return std::numeric_limits<double>::epsilon() * std::abs(value);
}
inline Rounded operator+(const Rounded& a, const Rounded& b) {
  const double value = a.value + b.value;
  return {value, a.error + b.error + RoundingOf(value)};
}
inline Rounded operator-(const Rounded& a, const Rounded& b) {
  const double value = a.value - b.value;
  return {value, a.error + b.error + RoundingOf(value)};
}
inline Rounded operator*(const Rounded& a, const Rounded& b) {
  const double value = a.value * b.value;
  return {
      value,
      std::abs(a.value) * b.error + a.error * (std::abs(b.value) + b.error) + RoundingOf(value)};
}
inline Rounded operator*(double a, const Rounded& b) {
  return {a * b.value, std::abs(a) * b.error + RoundingOf(a * b.value)};
}

// Coefficients of τ^0, τ^1, …; results are as long as the shorter operand.
using Series = std::vector<Rounded>;
Series operator+(const Series& a, const Series& b);
Series operator-(const Series& a, const Series& b);
Series operator*(const Series& a, const Series& b);

// The first significant coefficient; none if there is none.
std::optional<int> LeadingOrder(const Series& a);

// Vectors in space.
struct VectorSeries {
  Series x, y, z;

  int size() const { return static_cast<int>(x.size()); }
  Eigen::Vector3d operator[](int k) const { return {x[k].value, y[k].value, z[k].value}; }
};
VectorSeries Cross(const VectorSeries& a, const VectorSeries& b);
Series Dot(const VectorSeries& a, const VectorSeries& b);
VectorSeries Derivative(const VectorSeries& a);
std::optional<int> LeadingOrder(const VectorSeries& a);

// Without the first `order` coefficients: a / τ^order where those vanish.
VectorSeries Shifted(const VectorSeries& a, int order);

// C(t + τ) of a piece up to τ^order for t in [0, 1], in its own parameter and relative to its
// origin; `backward` gives C(t − τ).
VectorSeries TaylorSeries(const CurvePiece& piece, double t, int order, bool backward);

// S(s + σ, t + τ) of a piece up to a total order.
class SurfaceSeries {
 public:
  SurfaceSeries(const SurfacePiece& piece, double s, double t, int order);

  // Along a ray from (s,t): derivatives with respect to s and t, at (s + a r, t + b r), as series
  // in r up to r^(order − i − j).
  VectorSeries AlongRay(int i, int j, double a, double b) const;

 private:
  const Rounded& At(int k, int l, int d) const { return table_[(k * (order_ + 1) + l) * 4 + d]; }

  int order_;
  std::vector<Rounded> table_;  // Taylor coefficients of x, y, z, and of the weight
};

}  // namespace batten::internal
