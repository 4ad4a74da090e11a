// SPDX-License-Identifier: MIT
// Branches cut at trim loops. Internal to geometry.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/surface_intersection.h"

namespace batten::internal {

// The parts of branches inside the trims of both surfaces. A branch that runs along a loop counts
// as inside. A closed branch that is cut begins at a cut. `tolerance` is in space.
std::vector<SurfaceBranch> BranchesInside(const NurbsSurface& first,
                                          const NurbsSurface& second,
                                          std::vector<SurfaceBranch> branches,
                                          double tolerance);

}  // namespace batten::internal
