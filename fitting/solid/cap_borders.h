// SPDX-License-Identifier: MIT
// Borders of surfaces that are closed by caps.
#pragma once

#include <vector>

#include "batten/geometry/quad_mesh.h"
#include "batten/geometry/triangle_surface.h"
#include "fitting/solid/surface_creases.h"

namespace batten::internal {

// The surface with caps, of it and of what lies between them, no smaller than a hundredth of its
// area, and borders of these that are no longer ragged: triangles are of the side that most about
// them are of, vertices of borders move to the middle of those beside them. No caps where none are
// left.
TriangleSurface WithEvenCaps(TriangleSurface surface);

// The creases that are not of caps, and the borders of these.
SurfaceCreases WithCapBorders(SurfaceCreases creases, const TriangleSurface& surface);

// The faces of a layout over caps: creases part them from the others. Throws RefusedData where they
// do not.
std::vector<int> CapFaces(const QuadMesh& layout, const TriangleSurface& surface);

}  // namespace batten::internal
