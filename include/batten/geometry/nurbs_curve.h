// SPDX-License-Identifier: MIT
// A NURBS curve in the plane or in space.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten {

// A point of a curve with its first three derivatives.
template <int Dim>
struct CurveJet {
  Eigen::Matrix<double, Dim, 1> point, first, second, third;
};

// C(u) = Σ N_i(u) w_i P_i / Σ N_i(u) w_i on the domain of its basis. A value: editing returns a new
// one. Parameters outside the domain are taken at its nearest end or, over a periodic basis, whole
// periods away; NaN, and ±∞ over a periodic basis, throw std::invalid_argument
// (SplineBasis::Clamp). A clamped curve meets its end control points exactly, and coincident
// control points give exactly that point and derivatives of zero. [Piegl & Tiller 1997, §4.2]
//
// Rounding, per coordinate; ε = 2^-52, p the degree, h the length of the span, and D the range of
// the coordinate over the span's p+1 control points. Sums run over control points less one of
// them, so what counts is D and not the distance from the origin:
//  · a point is right to (7p + 3)·ε·D + ε·|C|, whatever the weights;
//  · the k-th derivative without weights to (4p + 1)·ε·D·p!/(p−k)!·(2/h)^k, zero above p;
//  · with weights to (k+1)(7p + k + 4)·ε·B_k, where B_k is what Leibniz' rule for C^(k) gives
//    with the absolute value of every term added: large where weights differ much.
template <int Dim>
class NurbsCurve {
 public:
  using Point = Eigen::Matrix<double, Dim, 1>;
  using Points = Eigen::Matrix<double, Dim, Eigen::Dynamic>;

  // Control points are Euclidean (Dim × n, the data's units); no weights means all ones. Throws
  // std::invalid_argument unless sizes agree, everything is finite, also weights times differences
  // of coordinates, weights are positive and, over a periodic basis, the last p control points and
  // weights are the first p.
  NurbsCurve(SplineBasis basis, Points control_points, Eigen::VectorXd weights = {});

  const SplineBasis& basis() const { return basis_; }
  const Points& control_points() const { return control_points_; }
  const Eigen::VectorXd& weights() const { return weights_; }
  bool rational() const { return rational_; }  // weights differ

  Point At(double u) const;

  // Point and derivatives up to the third, without allocating; right-continuous at knots, left at
  // the upper end.
  CurveJet<Dim> JetAt(double u) const;

  // Column k is the k-th derivative, k = 0 … order ≥ 0; from the same side. [A3.2, A4.2]
  Points Derivatives(double u, int order) const;

  bool operator==(const NurbsCurve&) const = default;

 private:
  SplineBasis basis_;
  Points control_points_;
  Eigen::VectorXd weights_;
  bool rational_;
};

extern template class NurbsCurve<2>;
extern template class NurbsCurve<3>;

}  // namespace batten
