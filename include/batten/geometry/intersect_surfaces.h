// SPDX-License-Identifier: MIT
// Where two surfaces meet: curves, places where they touch, regions in which they coincide.
#pragma once

#include <optional>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/surface_intersection.h"

namespace batten {

struct IntersectOptions {
  // How far curves may be from the surfaces, > 0, in the data's units; none: 1e-6 of the smaller
  // of the two diagonals of the boxes of the control points. Never less than 1e-12 of the larger
  // and 64 units in the last place of the largest coordinate.
  std::optional<double> tolerance = std::nullopt;
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
