// SPDX-License-Identifier: MIT
// Where a plane meets surfaces and curves.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The points x with normal·x = offset. The normal need not have length one; the side it points to
// is above.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0;
};

// normal·x − offset over the normal's length: the signed distance, in the data's units.
double HeightAbove(const Plane& plane, const Eigen::Vector3d& x);

struct SectionOptions {
  // How far the curves may be from the true section, > 0, in the data's units; none: 1e-9 of the
  // diagonal of the box of the control points. Never less than the rounding of the coordinates.
  std::optional<double> tolerance = std::nullopt;
};

// One piece of a section. Both curves have the same parameter, about arc length: parameters.At(t)
// is where on the surface points.At(t) is. Cubic and C¹; a corner, where the surface has a crease,
// is a knot of multiplicity 3.
struct SectionCurve {
  NurbsCurve<2> parameters;  // in the domain; what is above the plane lies on its left
  NurbsCurve<3> points;      // in the plane
  bool closed = false;       // in the domain
};

struct PlaneSection {
  std::vector<SectionCurve> curves;
  // The edges of the domain that lie in the plane: a straight line in the domain and the iso-curve,
  // with the inside on the left where that is above. No edges collapsed to a point; of a seam, one.
  std::vector<SectionCurve> edges;
  // A place (u, v) on each curve along which surface and plane only touch; those are left out.
  std::vector<Eigen::Vector2d> touches;
  bool contains_patch = false;  // a pair of spans lies in the plane wholly, to the tolerance
};

// All curves in which the surface's whole domain meets the plane: trims are not looked at
// (SectionInside cuts at them). Complete in this sense: where the surface is above the plane by
// more than the tolerance and elsewhere below by more than it, curves run between; on both sides of
// every curve the signs are those of the surface, at the corners of cells that are proved to hide
// nothing greater than the tolerance or narrower than 2^-20 of a span.
//
// Each curve keeps the tolerance: at equal t its two curves are that near to each other in space,
// and across the curve the true section is that near (where surface and plane meet at less than
// 0.01 rad, 0.01/angle times as near; the distance from the plane keeps it always).
//
// Clear results where plane and surface do not cross:
//  · a tangent point or a tangent curve is no section curve (along what is left out they meet at
//    less than 1e-6 rad everywhere);
//  · an edge in the plane is no section curve but one of `edges`;
//  · a pair of spans in the plane counts as above it: its border is a section curve where the
//    surface goes on below, and none where it goes on above.
// A curve ends at the edges of the domain: at the seam of a closed surface it goes on from the
// other edge, at a pole from elsewhere on the edge (see JoinedInSpace).
// Throws std::invalid_argument where the normal is zero or not finite, the offset not finite or the
// tolerance not positive. O(cells + curve length / tolerance^(1/4)).
PlaneSection Section(const NurbsSurface& surface,
                     const Plane& plane,
                     const SectionOptions& options = {});

// What of a section lies inside the surface's trim loops: curves are cut where they cross them. An
// edge that a loop runs along counts as inside.
PlaneSection SectionInside(const NurbsSurface& surface, PlaneSection section);

// The curves in space, those that end where another begins joined: at seams and poles, and into
// themselves. Ends count as one where they are within `tolerance`, in the data's units.
std::vector<NurbsCurve<3>> JoinedInSpace(std::vector<NurbsCurve<3>> curves, double tolerance);

// A place where a curve meets a plane.
struct PlaneCrossing {
  double u;
  bool touches;  // it is on the same side before and behind
};

// All places where the curve is in the plane, in increasing order: every change of side, and every
// touch within `tolerance` > 0 (in the data's units). A stretch in the plane is given by its ends,
// to knots. Each is right to rounding. Throws std::invalid_argument as Section does.
std::vector<PlaneCrossing> Crossings(const NurbsCurve<3>& curve,
                                     const Plane& plane,
                                     double tolerance);

}  // namespace batten
