// SPDX-License-Identifier: MIT
// A trimmed surface as a face of OpenCASCADE. Not installed; includes OpenCASCADE.
#pragma once

#include <TopoDS_Face.hxx>

#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// The face on a trimmed surface that is not periodic (closed directions have coincident edges),
// with a wire for every loop, the outer one first. The loops' pieces (trim_pieces.h) are the
// edges' curves on the surface as they are; their curves in space are splines within 1e-9 of the
// surface's size where OpenCASCADE reaches that. Pieces on both sides of a seam are one edge, those
// on an edge that is a point are degenerate. Throws Standard_Failure where OpenCASCADE fails.
TopoDS_Face ToTrimmedFace(const NurbsSurface& surface);

}  // namespace batten::internal
