// SPDX-License-Identifier: MIT
// Where two surfaces meet: curves, places where they touch, regions in which they coincide.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/parameter_box.h"

namespace batten {

struct IntersectOptions {
  // How far curves may be from the surfaces, > 0, in the data's units; none: 1e-6 of the smaller
  // of the two diagonals of the boxes of the control points. Never less than 1e-12 of the larger
  // and 64 units in the last place of the largest coordinate.
  std::optional<double> tolerance = std::nullopt;
};

enum class BranchKind {
  kTransversal,  // the surfaces cross
  kTangential,   // they touch along it
  kOverlap       // an edge of a region in which they coincide
};
// "transversal", "tangential", "overlap"
const char* NameOf(BranchKind kind);

// A curve along which two surfaces meet. All curves have the same parameter, about arc length:
// on_first[k].At(t) and on_second[k].At(t) are where on the surfaces curve.At(t) is.
struct SurfaceBranch {
  BranchKind kind = BranchKind::kTransversal;
  bool closed = false;  // in space
  // Cubic and C¹; a corner, where a surface has a crease, is a knot of multiplicity 3.
  NurbsCurve<3> curve;
  // In the domains, over consecutive parts of the curve's domain: one each, unless the branch
  // runs over a seam, where the next goes on from the other edge. None for an overlap along a seam
  // of that surface.
  std::vector<NurbsCurve<2>> on_first, on_second;
  // The greatest distance of the curve from either surface at equal parameters, measured at nine
  // places between any two knots.
  double deviation = 0;
};

// A place where the surfaces touch and do not cross, or where branches cross each other.
struct SurfaceTouch {
  Eigen::Vector3d point;
  Eigen::Vector2d on_first, on_second;
  bool on_branch = false;  // a branch passes
};

// A region in which the surfaces are the same to the tolerance: boxes that hold it.
struct SurfaceOverlap {
  ParameterBox first, second;
  Eigen::Vector3d point;  // one place of it
};

struct SurfaceIntersection {
  std::vector<SurfaceBranch> branches;
  std::vector<SurfaceTouch> touches;
  std::vector<SurfaceOverlap> overlaps;
  double tolerance = 0;  // what was worked with
};

// Everything in which the parts of two surfaces inside their trims meet.
//
// Complete in this sense: a branch can hide only where the surfaces are nearer to one another than
// the tolerance, or in rectangles of their domains smaller than that. All other pairs of patches
// are proved to be separate or to hold one branch that is found (pair_search.h). Branches end at
// the domains' borders, at trim loops, at poles and cusps; they go on over creases and seams.
// Surfaces that cross at an angle that changes by less than three times itself only where they are
// flat to the tolerance count as touching there.
//
// Each branch keeps the tolerance: its three curves are that near to each other at equal
// parameters, and across it the true branch is that near (where the surfaces meet at less than
// 0.01 rad, 0.01/angle times as near).
//
// Regions in which the surfaces coincide are told by samples, 25 a patch; their edges are branches
// of kind kOverlap where they are edges of the surfaces' domains.
//
// Throws std::invalid_argument where the tolerance is not positive, a trim is not a loop, or the
// surfaces are nearly the same over so large a part that three million pairs of patches do not
// tell them apart: the message says where. O(pieces · log pieces + pairs of patches near the
// branches). [Patrikalakis & Maekawa 2002, ch. 5; Sederberg, Christiansen & Katz 1989]
SurfaceIntersection IntersectSurfaces(const NurbsSurface& first,
                                      const NurbsSurface& second,
                                      const IntersectOptions& options = {});

}  // namespace batten
