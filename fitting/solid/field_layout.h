// SPDX-License-Identifier: MIT
// Layouts of quadrilaterals whose faces follow a field of directions.
#pragma once

#include "batten/fitting/progress.h"
#include "batten/geometry/quad_mesh.h"
#include "batten/geometry/triangle_surface.h"
#include "fitting/solid/surface_creases.h"
#include "fitting/solid/surface_projector.h"

namespace batten::internal {

inline constexpr int kFewestFaces = 60;  // coarser layouts seldom follow a shape

// A layout of about so many faces, all of one size or smaller where the surface bends: the squares
// of a grid onto which the surface is mapped along a smooth field of crosses. Few vertices have
// other than four edges: those about which the crosses turn. Throws RefusedData where no layout of
// the surface's Euler number comes out, or one whose faces turn over. [field: Knöppel et al. 2013;
// map: Bommes, Zimmer & Kobbelt 2009]
// Creases become edges of the layout.
QuadMesh FieldLayout(const TriangleSurface& surface,
                     const SurfaceCreases& creases,
                     const SurfaceProjector& projector,
                     double faces,
                     bool by_curvature,
                     const Progress& progress);

}  // namespace batten::internal
