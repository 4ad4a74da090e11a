// SPDX-License-Identifier: MIT
// Points and derivatives of rational shapes as linear forms of their control points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// How many control points of a basis differ: over a periodic basis number i stands for i +
// k·DistinctPoints too.
inline int DistinctPoints(const SplineBasis& basis) {
  return basis.periodic() ? basis.size() - basis.degree() : basis.size();
}

// Distinct control points by number, on surfaces i · (distinct ones in v) + j.
template <int Dim>
Eigen::Index DistinctPoints(const NurbsCurve<Dim>& curve) {
  return DistinctPoints(curve.basis());
}
inline Eigen::Index DistinctPoints(const NurbsSurface& surface) {
  return Eigen::Index{DistinctPoints(surface.basis_u())} * DistinctPoints(surface.basis_v());
}

// Σ values[k] · P_index[k] over distinct control points; no index stands twice.
struct ControlForm {
  std::vector<Eigen::Index> index;
  Eigen::VectorXd values;

  double At(Eigen::Index control_point) const;  // 0 where it does not act
};

// Adds a term to a form whose values have room for it; the control point may be in it already.
void AddTerm(ControlForm& form, Eigen::Index control_point, double value);

// The form that gives a derivative of the shape, order 0 the point, at its present weights: the
// values are derivatives of rational basis functions. From the right at knots, at the upper end
// from the left. The parameter is in the domain, orders are not negative. O(p·order²) for curves,
// O(pq·order_u²·order_v²) for surfaces. [Piegl & Tiller 1997, §4.3, §4.5]
template <int Dim>
ControlForm DerivativeForm(const NurbsCurve<Dim>& curve, double u, int order = 0);
ControlForm DerivativeForm(
    const NurbsSurface& surface, double u, double v, int order_u = 0, int order_v = 0);

// The shape whose distinct control point k is moved by moves.col(k), copies along with it. Weights,
// knots and trims stay.
template <int Dim>
NurbsCurve<Dim> WithMoves(const NurbsCurve<Dim>& curve, const Eigen::MatrixXd& moves);
NurbsSurface WithMoves(const NurbsSurface& surface, const Eigen::MatrixXd& moves);

}  // namespace batten::internal
