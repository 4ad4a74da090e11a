// SPDX-License-Identifier: MIT
// The length of curves and the parameter at a length.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten {

// ∫ |C′(u)| du over the domain, in the data's units. Gauss–Legendre rules of 20 and 12 nodes on
// every knot span. A stretch is halved where the two differ, and where the Bézier points of C′ do
// not prove that no cusp hides in it, until what is uncertain sums to less than 1e-13 of the
// length. The error is then below 1e-12 of the length, cusps and near-cusps included, or at the
// rounding of the control points, whichever is greater. O(pieces · p²), about a microsecond a span
// for cubics. [Davis & Rabinowitz 1984, §6.2]
template <int Dim>
double ArcLength(const NurbsCurve<Dim>& curve);

// The length between parameters a ≤ b of the domain, relative to that length as exact as above.
// Over a periodic basis a may be anywhere and b up to one period further. Throws
// std::invalid_argument otherwise.
template <int Dim>
double ArcLength(const NurbsCurve<Dim>& curve, double a, double b);

// The parameter at length s from the beginning of the domain: ArcLengthMap once. For many lengths
// keep the map.
template <int Dim>
double ParameterAtLength(const NurbsCurve<Dim>& curve, double s);

// The length as a function of the parameter and its inverse, from a table of stretches on each of
// which one Gauss rule is exact. Building costs one ArcLength.
class ArcLengthMap {
 public:
  template <int Dim>
  explicit ArcLengthMap(const NurbsCurve<Dim>& curve);

  double length() const { return length_; }

  // The length from the beginning of the domain to u, u taken into the domain by
  // SplineBasis::Clamp. O(log stretches + p).
  double LengthAt(double u) const;

  // The parameter u with LengthAt(u) = s to 1e-13 of the length, by Newton steps kept between
  // bounds. Where the curve rests at a point it is one of the parameters of that point. Throws
  // std::invalid_argument unless 0 ≤ s ≤ length(), 1e-12 of the length beyond either end allowed.
  double ParameterAt(double s) const;

 private:
  // Of piece number `piece`, between its own parameters t0 and t1; `before` is the length up to t0.
  struct Stretch {
    int piece;
    double t0, t1, before, length;
  };

  double PartOf(const Stretch& stretch, double t) const;

  SplineBasis basis_;
  std::vector<Eigen::Matrix4Xd> pieces_;
  std::vector<double> breaks_;  // piece k is over [breaks k, breaks k + 1]
  std::vector<Stretch> stretches_;
  double length_ = 0;
};

extern template double ArcLength(const NurbsCurve<2>&);
extern template double ArcLength(const NurbsCurve<3>&);
extern template double ArcLength(const NurbsCurve<2>&, double, double);
extern template double ArcLength(const NurbsCurve<3>&, double, double);
extern template double ParameterAtLength(const NurbsCurve<2>&, double);
extern template double ParameterAtLength(const NurbsCurve<3>&, double);
extern template ArcLengthMap::ArcLengthMap(const NurbsCurve<2>&);
extern template ArcLengthMap::ArcLengthMap(const NurbsCurve<3>&);

}  // namespace batten
