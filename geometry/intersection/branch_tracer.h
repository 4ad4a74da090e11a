// SPDX-License-Identifier: MIT
// A branch of an intersection followed from one place to both its ends. Internal to geometry.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "geometry/intersection/pair_contact.h"

namespace batten::internal {

// A cubic in space and in both domains over [0, length], through two places with their tangents.
struct MeetArc {
  double length;
  Eigen::Matrix<double, 3, 4> points;
  Eigen::Matrix4d places;
};

MeetArc ArcBetween(const MeetPoint& a, const MeetPoint& b);

struct TracedBranch {
  std::vector<MeetPoint>
      stations;  // a cubic between each two; of a closed one the last is the first
  bool closed = false;
  MeetKind kind = MeetKind::kCrossing;
  double deviation = 0;                    // the greatest measured
  std::vector<Eigen::AlignedBox3d> boxes;  // of the cubics

  // Whether the branch passes within `reach` of a place of both domains.
  bool Passes(const MeetPoint& place, double reach) const;
};

// Cubics as long as keep the tolerance are laid along the branch, each proved at places inside
// it: how far its two curves in the domains are from its curve in space, and from each other, that
// over the sine of the angle between the surfaces where it is above 0.01. A step that misses is
// shortened by the fourth root of by how much. The branch ends where it comes back to the start,
// at the borders of the boxes, exactly, and where it stands still: at a pole, a cusp.
// [Patrikalakis & Maekawa 2002, §5.8]
TracedBranch TraceBranch(const PairContact& contact, const Eigen::Vector4d& start);

}  // namespace batten::internal
