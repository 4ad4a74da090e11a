// SPDX-License-Identifier: MIT
// Foot points on a limit surface.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "geometry/subdivision/limit_surface.h"

namespace batten::internal {

struct LimitFoot {
  LimitPlace place;
  Eigen::Vector3d point = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
  bool on_crease = false;
  Eigen::Vector3d tangent = Eigen::Vector3d::Zero();  // of the crease, zero at a corner
  bool found = false;  // on a part of the surface whose normal agrees with the point's
};

// How much normals of a point and its foot may differ.
inline constexpr double kLeastCosine = 0.5;  // 60°: on a thin wall the other side is at 180°

// Where feet may be: on all patches of a surface but those left out, which creases divide from the
// others.
struct FootGround {
  const LimitSurface& surface;
  int patches;
  const std::vector<char>& left_out;  // by patch; empty: none

  bool Has(int patch) const { return left_out.empty() || !left_out[std::size_t(patch)]; }
};

// The feet of points with normals (zero: none; `oriented`: their signs count). With feet to begin
// from they are followed, else the nearest places of a grid of samples with such a normal are.
std::vector<LimitFoot> FeetOn(const FootGround& ground,
                              const Eigen::Matrix3Xd& points,
                              const Eigen::Matrix3Xd& normals,
                              bool oriented,
                              const std::vector<LimitFoot>& from,
                              ThreadPool& pool);

}  // namespace batten::internal
