// SPDX-License-Identifier: MIT
// A trimmed surface as faces of OpenCASCADE. Not installed; includes OpenCASCADE.
#pragma once

#include <TopoDS_Shape.hxx>

#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// The face on a trimmed surface that is not periodic (closed directions have coincident edges),
// with a wire for every loop, the outer one first; a compound of one face for each region where
// there are several, all on one surface. The loops' pieces (trim_pieces.h) are the edges' curves on
// the surface as they are; their curves in space are splines within 1e-9 of the surface's size
// where OpenCASCADE reaches that. Pieces on both sides of a seam are one edge, those on an edge
// that is a point are degenerate. Throws Standard_Failure where OpenCASCADE fails.
TopoDS_Shape ToTrimmedFaces(const NurbsSurface& surface);

}  // namespace batten::internal
