// SPDX-License-Identifier: MIT
// Surfaces cut into parts by planes and curves.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/plane_section.h"

namespace batten {

// The parts on either side, each one connected in the parameter domain: a part that goes over the
// seam of a closed surface comes as its parts on either side of the seam.
struct SurfaceCut {
  std::vector<NurbsSurface> left;  // of the curve; above the plane
  std::vector<NurbsSurface> right;
};

// The surface on both sides of a plane: the same surface trimmed by loops that are made of pieces
// of its own outer boundary and holes and of the section curves, which the parts on either side
// share control point by control point. Where all sections of an untrimmed surface are iso-lines,
// to 1e-9 of the domain, the parts are split off exactly and have no
// trims. A surface that the plane does not cut, or only touches, comes whole, on the side of its
// place farthest from the plane. Throws std::invalid_argument as Section does, and where loops and
// sections touch in a way that cannot be told apart at 1e-9 of the domain.
SurfaceCut CutByPlane(const NurbsSurface& surface,
                      const Plane& plane,
                      const SectionOptions& options = {});

// The surface on both sides of a curve in its parameter domain, which must be closed, or go through
// what the loops leave; parts of it outside are dropped. Left of a closed curve is its inside,
// however it is turned. Throws std::invalid_argument where the curve does not cut the surface, ends
// inside, runs along a loop, or crosses itself.
SurfaceCut CutAlong(const NurbsSurface& surface, const NurbsCurve<2>& curve);

// The same with a curve in space, projected onto the surface within `tolerance` > 0, in the data's
// units (project_curve.h).
SurfaceCut CutAlong(const NurbsSurface& surface, const NurbsCurve<3>& curve, double tolerance);

}  // namespace batten
