// SPDX-License-Identifier: MIT
// What becomes of the parts in which two surfaces are within the tolerance of each other and not
// transversal. Internal to geometry.
#pragma once

#include <vector>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/surface_intersection.h"
#include "geometry/intersection/pair_search.h"

namespace batten::internal {

struct ContactResult {
  std::vector<TracedBranch> branches;  // along which the surfaces touch
  std::vector<SurfaceTouch> touches;
  std::vector<SurfaceOverlap> overlaps;
};

// Neighbouring contacts form a cluster. One that is smaller than 8 √(tolerance · size) is a touch;
// in another one branches of touching are traced, and what neither these nor the branches known
// pass near is a region in which the surfaces coincide. Places are about the trees' origin.
ContactResult ExplainContacts(const PatchTree& a,
                              const PatchTree& b,
                              const SurfaceFootPoints& feet_b,
                              const FoundMeets& found,
                              double tolerance);

}  // namespace batten::internal
