// SPDX-License-Identifier: MIT
// Where curves and surfaces close, how smoothly their pieces join, and which edges are points.
#pragma once

#include <optional>
#include <vector>

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// Tolerances here are relative to the diagonal of the box of the control points.
inline constexpr double kCloses = 1e-9;

// Whether the two ends of the domain are one point.
template <int Dim>
bool Closed(const NurbsCurve<Dim>& curve, double tolerance = kCloses);

// Whether the two edges that bound the direction are one curve, parameter by parameter: compared
// at 2 q + 2 places in every span along them (q the degree there), more than the numerator of their
// difference has zeros.
bool Closed(const NurbsSurface& surface, Direction direction, double tolerance = kCloses);

// How two pieces join at a knot.
struct KnotContinuity {
  double knot;
  int multiplicity;
  int guaranteed;  // degree − multiplicity, whatever the control points
  int actual;  // the highest k ≤ degree with derivatives 0 … k equal; never below `guaranteed`
};

// At every interior knot in increasing order. Derivatives count as equal where the k-th differ by
// at most `tolerance` · k! / h^k of the two pieces' size, h the longer of the two spans, or by
// rounding. `actual` = degree says that the knot makes no difference, or none that k ≤ degree
// shows. Of the curve itself, not of its homogeneous form: a circle of rational arcs is C^1 where
// their knots are double. O(knots · p³).
template <int Dim>
std::vector<KnotContinuity> ContinuityAtKnots(const NurbsCurve<Dim>& curve,
                                              double tolerance = kCloses);

// The same for the knots of one direction: the least over parameter lines across them, 2 q + 2 in
// every span and 200 in all at most.
std::vector<KnotContinuity> ContinuityAtKnots(const NurbsSurface& surface,
                                              Direction direction,
                                              double tolerance = kCloses);

// The continuity from the end of the domain to its beginning, 0 … degree; none where not closed.
template <int Dim>
std::optional<int> SeamContinuity(const NurbsCurve<Dim>& curve, double tolerance = kCloses);
std::optional<int> SeamContinuity(const NurbsSurface& surface,
                                  Direction direction,
                                  double tolerance = kCloses);

// Which bounding edges are one point each (poles, tips): there all control points of the edge
// coincide.
struct CollapsedEdgeSet {
  bool u_lower = false, u_upper = false, v_lower = false, v_upper = false;

  bool operator==(const CollapsedEdgeSet&) const = default;
};
CollapsedEdgeSet CollapsedEdges(const NurbsSurface& surface, double tolerance = kCloses);

extern template bool Closed(const NurbsCurve<2>&, double);
extern template bool Closed(const NurbsCurve<3>&, double);
extern template std::vector<KnotContinuity> ContinuityAtKnots(const NurbsCurve<2>&, double);
extern template std::vector<KnotContinuity> ContinuityAtKnots(const NurbsCurve<3>&, double);
extern template std::optional<int> SeamContinuity(const NurbsCurve<2>&, double);
extern template std::optional<int> SeamContinuity(const NurbsCurve<3>&, double);

}  // namespace batten
