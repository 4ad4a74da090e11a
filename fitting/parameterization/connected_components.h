// SPDX-License-Identifier: MIT
// Connected components of points in a plane.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace batten::internal {

// Returns the share of points (2 × m) that are detached from the largest component: in components
// of their own, farther from it than ten times the distance of their own neighbours. Points joined
// by a bridge of points, or across a gap of a few spacings, are one component, even if the density
// differs. Duplicates and points over each other are allowed: if no component holds 2 % of the
// points, each component is replaced by one place. O(m log m); a sample of 20 000 is taken of more
// points.
double DetachedFraction(const Eigen::Matrix2Xd& places, std::uint64_t seed = 1);

}  // namespace batten::internal
