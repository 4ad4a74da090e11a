// SPDX-License-Identifier: MIT
// The loops that trim a surface: their areas, their turning, their polygons, their rules.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The area inside a closed plane curve, positive where it runs counter-clockwise: ∮ (x dy − y dx)/2
// about the curve's first control point. Exact to rounding where the weights are all the same (by
// Gauss–Legendre rules of p nodes a span), else by adaptive rules to 1e-13 of Σ |area| of the
// spans. The ends count as joined by a straight line.
double SignedArea(const NurbsCurve<2>& loop);

// The loop of greatest area first and counter-clockwise, then the others in their order, clockwise.
std::vector<NurbsCurve<2>> TurnedLoops(std::vector<NurbsCurve<2>> loops);

// The loops of a surface's trims by the regions they bound: an outer loop, counter-clockwise, and
// the holes in it, clockwise; regions in the order of their outer loops. Empty without trims. The
// loops must be as CheckTrims wants them. O(loops² · vertices of their polygons).
std::vector<std::vector<NurbsCurve<2>>> LoopsByRegion(const NurbsSurface& surface);

// A loop as a polygon: its vertices, in order, lie on the loop at increasing parameters; the last
// is joined to the first.
struct Polygon {
  Eigen::VectorXd parameters;
  Eigen::Matrix2Xd points;
};

// The polygon from which the loop is nowhere farther away than `tolerance`, in the parameters'
// units: every Bézier piece is halved until its control points are that near to their chord. Ends
// of pieces are vertices, and so are three places between them at least, unless they are straight:
// a loop of one piece still bounds an area. The point at the end of the domain is not repeated.
// Throws std::invalid_argument unless the tolerance is positive. Pieces below 2^-20 of a span are
// not halved.
Polygon LoopPolyline(const NurbsCurve<2>& loop, double tolerance);

// Throws std::invalid_argument, naming the loop and the rule, unless the surface's loops
//  · end where they begin, to kLoopClosure of the domain,
//  · lie in the domain to 1e-9 of it,
//  · bound an area, the first one counter-clockwise,
//  · wind 0 or 1 times round every place: none crosses itself or another, outer loops, which run
//    counter-clockwise, lie outside one another or in holes, and holes, which run clockwise, lie
//    inside an outer loop and not in each other. They may touch.
// What is narrower than 1e-9 of the domain is not seen. Two neighbouring arcs are compared, where
// they are nearest first, at no more than 256 heights between two ends of arcs: of arcs that run
// along one another a crossing that is shorter can be missed. O(arcs · arcs at one height).
void CheckTrims(const NurbsSurface& surface);

}  // namespace batten
