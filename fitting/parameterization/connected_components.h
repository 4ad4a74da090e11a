// SPDX-License-Identifier: MIT
// Whether points in a plane hang together.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace batten::internal {

// The share of points (2 × m) that lie apart from the largest part of them: in parts of their own,
// farther from it than ten times the distance at which they have neighbours themselves. What
// hangs together by a bridge of points, or over a gap of a few spacings, is one part, however the
// density differs. Duplicates and points over each other do no harm: where no part holds 2 % of the
// points, parts are taken for places. O(m log m); of more than 20 000 points so many are looked at.
double DetachedFraction(const Eigen::Matrix2Xd& places, std::uint64_t seed = 1);

}  // namespace batten::internal
