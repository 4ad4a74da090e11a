// SPDX-License-Identifier: MIT
// The B-spline functions N_0 … N_{n-1} of one degree over one knot vector.
#pragma once

#include <span>
#include <vector>

namespace batten {

// The highest degree batten works with: OpenCASCADE's own limit, so that everything can be
// exported.
inline constexpr int kMaxDegree = 25;

// The B-spline functions N_0 … N_{n-1} of degree p over the knots u_0 ≤ … ≤ u_{n+p}.
//  (1) On the closed domain [u_p, u_n]: N_i ≥ 0 and Σ N_i = 1.
//  (2) N_i vanishes outside [u_i, u_{i+p+1}], is positive inside and has one maximum.
//  (3) At a knot of multiplicity k the derivatives up to order p − k are continuous.
//  (4) On every non-empty span the p+1 functions that live there span all polynomials of degree p.
// n counts functions (control points); Piegl & Tiller write n + 1. Knots may be clamped or not.
// A basis may be periodic: then the knots repeat after m = n − p of them, u_{i+m} = u_i + T with
// the period T = u_n − u_p, the last p functions continue the first p, and whatever is built on it
// has p control points repeated at the end. [Piegl & Tiller 1997, §2.2, §12.2]
//
// Rounding, ε = 2^-52: the values are sums of positive terms only, so each is right to 3p·ε of
// itself, however uneven the knots are. A k-th derivative is a difference of larger terms; it is
// right to 3p·ε of the sum of their absolute values, which over a span of length h is at most
// p!/(p−k)!·(2/h)^k.
class SplineBasis {
 public:
  // Throws std::invalid_argument unless 1 ≤ degree ≤ kMaxDegree, the knots are finite and
  // non-decreasing, n > degree, the domain is not empty, and no interior knot is repeated more than
  // degree times (end knots: degree + 1): such a spline is continuous. Differences of knots must be
  // zero or normal doubles: not above 1.8e308, not below 2.2e-308.
  SplineBasis(int degree, std::vector<double> knots);

  // The same, periodic. Also throws unless the knots repeat after n − degree of them, to 1e-12 of
  // the greater of the period and the largest knot.
  static SplineBasis Periodic(int degree, std::vector<double> knots);

  // The clamped basis with simple interior knots at the inner of the increasing `breaks`.
  static SplineBasis Clamped(int degree, std::span<const double> breaks);

  // The clamped basis of `size` functions with equal spans on [lower, upper].
  static SplineBasis Uniform(int degree, int size, double lower, double upper);

  int degree() const { return degree_; }
  int size() const { return static_cast<int>(knots_.size()) - degree_ - 1; }
  const std::vector<double>& knots() const { return knots_; }
  double lower() const { return knots_[degree_]; }
  double upper() const { return knots_[size()]; }
  bool periodic() const { return periodic_; }

  // Whether the domain begins and ends at a knot of multiplicity degree + 1.
  bool clamped() const { return knots_.front() == lower() && knots_.back() == upper(); }

  // The index i with u_i ≤ u < u_{i+1} among the spans of the domain; parameters outside are taken
  // at the nearest end, and the upper end belongs to the last non-empty span. Throws
  // std::invalid_argument if u is NaN. O(1) where knots are nearly even, O(log n) at most. [A2.1]
  int Span(double u) const;

  // Every span of positive length inside the domain, in increasing order.
  std::vector<int> Spans() const;

  // The p+1 functions that do not vanish on `span`: values[r] = N_{span-p+r}(u). [A2.2]
  void Values(int span, double u, double* values) const;

  // Their derivatives: values[k·(p+1)+r] = d^k N_{span-p+r} / du^k for k = 0 … order, all zero for
  // k > p. Right-continuous at knots because `span` says which piece is meant. [A2.3]
  void Derivatives(int span, double u, int order, double* values) const;

  // N_i(u), and its derivatives values[k] for k = 0 … order, as Span and Derivatives take the
  // parameter. Throws std::invalid_argument unless 0 ≤ i < size, order ≥ 0 and u is a number. For
  // one function alone; all that act at u come at the same price from Values. [A2.4, A2.5]
  double Function(int i, double u) const;
  std::vector<double> FunctionDerivatives(int i, double u, int order) const;

  // Greville abscissa (u_{i+1} + … + u_{i+p}) / p: with these as control points the spline is u.
  double Greville(int i) const;

  // The parameter of the domain that stands for u: itself inside the closed domain; outside, the
  // nearest end, or for a periodic basis the place in [lower, upper) that lies whole periods away,
  // exact to rounding of the domain's ends. Throws std::invalid_argument if u is NaN, and over a
  // periodic basis if it is infinite.
  double Clamp(double u) const;

  // How often the value stands in the knot vector, exactly.
  int Multiplicity(double knot) const;

  bool operator==(const SplineBasis&) const = default;

 private:
  double Wrap(double u) const;

  int degree_;
  std::vector<double> knots_;
  double spans_per_length_ = 0;  // (n − p) over the length of the domain
  bool periodic_ = false;
};

}  // namespace batten
