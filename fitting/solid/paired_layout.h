// SPDX-License-Identifier: MIT
// Layouts of quadrilaterals made by pairing triangles.
#pragma once

#include "batten/fitting/progress.h"
#include "batten/geometry/quad_mesh.h"
#include "batten/geometry/triangle_surface.h"
#include "fitting/solid/surface_projector.h"

namespace batten::internal {

// A layout of about so many faces: triangles of even size, paired over the edges by a perfect
// matching of greatest weight, which exists [Petersen 1891], and improved by turning edges until
// fewer vertices have other than four. Of those there remain many. Throws RefusedData where no
// layout of the surface's Euler number comes out. [pairing: Remacle et al. 2012]
QuadMesh PairedLayout(const TriangleSurface& surface,
                      const SurfaceProjector& projector,
                      int faces,
                      const Progress& progress);

}  // namespace batten::internal
