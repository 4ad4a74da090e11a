// SPDX-License-Identifier: MIT
// Reparameterization by polynomials and splines: the composition of a shape with a function.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/spline_basis.h"

namespace batten {

// The function f(s) = Σ N_i(s)·c_i, one coefficient for each function of the basis; a polynomial is
// one over a basis without interior knots. Over a periodic basis f gains the same amount in every
// round: c_{i+m} = c_i + f(upper) − f(lower), m = size − degree.
struct ScalarSpline {
  SplineBasis basis;
  Eigen::VectorXd coefficients;

  double At(double s) const;  // the parameter is clamped to the closed domain
};

// The same shape traced by s: the result at s is C(f(s)), where f has degree q and increases
// strictly from the lower to the upper end of the domain of C, to 1e-12 of the domain.
//  (1) The result has degree p·q over the domain of f. Its knots are those of f and the places
//      that f maps to knots of C. Where f has a knot of multiplicity k and C one of multiplicity l,
//      it is continuous of order min(q − k, p − l), and its knot has multiplicity p·q less that.
//  (2) Where f and C are periodic, so is the result. Otherwise it is clamped.
//  (3) Non-rational stays so. Where a control point would lie far off (a weight below 1/16 of the
//      smallest of C, or not even positive, or a coordinate above 16 times the largest of C), knots
//      are inserted, first up to multiplicity p·q, then halfway: enough of them bring every control
//      point near the shape.
// Each control point is the blossom of C∘f at its knots: the mean, over all ways to deal its p·q
// knots out into p groups of q, of the blossom of C at the values of the blossom of f at the
// groups. Rounding: with E the largest coordinate, D the greatest speed |C'|, F the greatest f' and
// L the greater of length and ends of the two domains, points are right to (16 + 2pq)·ε·(E + D·(L_C
// + F·L_f)), ε = 2^-52: as if parameters were moved by some
// roundings; what f misses the ends of C by comes on top. Pieces of C that are shorter
// than 16 roundings of the values of f, or 4 times what f misses its ends by, are passed over.
// O(p³·q²) for each control point, at most.
//
// Throws std::invalid_argument if p·q > 25, sizes differ, f cannot be shown to increase strictly
// (by the signs of its Bézier coefficients after 40 halvings), does not end at the ends of the
// domain, or is so steep that doubles s do not resolve the pieces of C, and for a trimmed surface,
// whose loops would be no NURBS curves any more. [DeRose, Goldman, Hagen &
// Mann 1993; Piegl & Tiller 1997, §6.4]
template <int Dim>
NurbsCurve<Dim> Composed(const NurbsCurve<Dim>& curve, const ScalarSpline& f);
NurbsSurface Composed(const NurbsSurface& surface, Direction direction, const ScalarSpline& f);

// s ↦ g(f(s)); g need not increase.
ScalarSpline Composed(const ScalarSpline& g, const ScalarSpline& f);

}  // namespace batten
