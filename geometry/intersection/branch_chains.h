// SPDX-License-Identifier: MIT
// Traced branches joined over creases and seams, and their curves. Internal to geometry.
#pragma once

#include <vector>

#include "batten/geometry/surface_intersection.h"
#include "geometry/intersection/branch_tracer.h"

namespace batten::internal {

// Consecutive runs of stations; the next begins where the one before ends, in space.
struct MeetChain {
  std::vector<std::vector<MeetPoint>> runs;
  bool closed = false;
  MeetKind kind = MeetKind::kCrossing;
};

// The branches, those that were traced twice along a crease once, joined where one ends and
// another of the same kind goes on, within `reach`: where several do, the one that turns least.
// O(branches²).
std::vector<MeetChain> ChainsOf(std::vector<TracedBranch> branches, double reach);

// The curves of a chain, the deviation left open. `widths` are those of the two domains, `origin`
// is added to points.
SurfaceBranch CurvesOf(const MeetChain& chain,
                       const Eigen::Vector4d& widths,
                       const Eigen::Vector3d& origin);

}  // namespace batten::internal
