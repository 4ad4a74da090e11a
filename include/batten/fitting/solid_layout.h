// SPDX-License-Identifier: MIT
// Layouts of quadrilaterals for solids, made from surfaces of triangles.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/progress.h"
#include "batten/geometry/quad_mesh.h"
#include "batten/geometry/triangle_surface.h"

namespace batten {

// A layout of about `faces` quadrilaterals over a closed surface, its vertices on it: the surface
// with triangles of even size, paired over the edges by a perfect matching of greatest weight,
// which exists [Petersen 1891], and improved by turning edges until fewer vertices have other than
// four. Extraordinary vertices are many; layouts of quadrilateral remeshers have fewer. Throws
// RefusedData where no layout of the same genus comes out; Cancelled when progress stops it.
// [even triangles: Botsch & Kobbelt 2004; pairing: Remacle et al. 2012]
QuadMesh LayoutOf(const TriangleSurface& surface, int faces, const Progress& progress = {});

// How many faces a layout gets where nobody says: one for so many points, fewer for those of a
// cloud than for the vertices of a mesh (`measured` surfaces), 60 to 2500.
int LayoutFaces(Eigen::Index points, bool measured);

}  // namespace batten
