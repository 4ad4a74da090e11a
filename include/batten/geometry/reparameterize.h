// SPDX-License-Identifier: MIT
// Another parameter for the same shape: linear and linear rational (Möbius) maps. Composition with
// polynomials and splines: composition.h.
#pragma once

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The same shape over the domain [a, b], a < b: only knots change, C̃(s) = C(f(s)) with f linear.
// Control points and weights stay bit by bit, the ends of the domain are a and b exactly, equal
// knots stay equal, periodic stays periodic. Throws std::invalid_argument if a < b does not hold or
// two different knots would fall together in the rounding of the new domain. Trims are scaled with
// the domain. O(n).
template <int Dim>
NurbsCurve<Dim> Reparameterized(const NurbsCurve<Dim>& curve, double a, double b);
NurbsSurface Reparameterized(const NurbsSurface& surface, Direction direction, double a, double b);

// The same shape traced by the new parameter s that is bound to the old one by
//   u = f(s) = (α·s + β) / (γ·s + δ),   αδ − βγ > 0,   so that   C̃(s) = C(f(s)).
// The domain and all knots are mapped by the inverse s = (δ·u − β) / (α − γ·u), control points stay
// bit by bit, and weight i is multiplied by (γs_{i+1} + δ) … (γs_{i+p} + δ), all relative to the
// value of γs + δ at the start of the domain, so that the weight there keeps its size. A map that
// turns [0, 1] onto itself thus changes only weights on a Bézier curve, and weights and interior
// knots on a spline. A curve without weights gets them, unless γ = 0. A Möbius map that is not
// linear has no period: a periodic shape comes back clamped and closed. An unclamped one stays
// unclamped unless one of its knots lies at or beyond the pole; then it is clamped first. Rounding:
// knots are right to some ε of the largest knot, weights to 4(p + 1)·ε; the point at s is moved as
// by such changes of knots and weights. Throws std::invalid_argument unless the coefficients are
// finite, αδ − βγ > 0, and γs + δ ≠ 0 on the new domain (that is α − γu ≠ 0 on the old one). Trims
// are mapped exactly: a loop of degree p becomes a rational one of degree 2p, over the same
// parameters and with the same continuity; throws where 2p is above kMaxDegree.
// O(p·n). [Piegl & Tiller 1997, §6.4, whose α, β, γ, δ are those of the inverse: pass δ, −β, −γ, α
// for them; Lee & Lucian 1991]
template <int Dim>
NurbsCurve<Dim> MobiusReparameterized(
    const NurbsCurve<Dim>& curve, double alpha, double beta, double gamma, double delta);
NurbsSurface MobiusReparameterized(const NurbsSurface& surface,
                                   Direction direction,
                                   double alpha,
                                   double beta,
                                   double gamma,
                                   double delta);

// The same shape over the same domain, traced so that the weight function Σ N_i·w_i is `first` at
// its start and `last` at its end; of a clamped curve these are the first and the last weight,
// exactly. There is one Möbius map of the domain onto itself that does it. Equal end weights are
// what curves need before they are joined smoothly in homogeneous space or made compatible for
// lofting. Throws std::invalid_argument unless both weights are positive and finite. The rest as
// above.
template <int Dim>
NurbsCurve<Dim> WithEndWeights(const NurbsCurve<Dim>& curve, double first, double last);

}  // namespace batten
