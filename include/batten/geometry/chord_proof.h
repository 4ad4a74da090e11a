// SPDX-License-Identifier: MIT
// Proof that a mesh follows its surface.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/tessellate.h"

namespace batten {

// The numbers of the triangles for which it is not proved that the surface over their parameters
// lies within `tolerance` (the data's units, > 0) of their planes: by the hulls of its Bézier
// points, halved a few hundred times at most (TriangleProof). A triangle without area is among
// them. The mesh must be one of the surface, as Tessellate makes it. Throws std::invalid_argument
// for a tolerance that is not positive. Some µs a triangle. [Lane & Riesenfeld 1980]
std::vector<int> UnprovedTriangles(const NurbsSurface& surface,
                                   const TriangleMesh& mesh,
                                   double tolerance);

}  // namespace batten
