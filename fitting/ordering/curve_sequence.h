// SPDX-License-Identifier: MIT
// Test whether points are in order along a curve.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// Whether the points (3 × m) are in order along one curve. False where they must be ordered by
// neighbourhoods first: they are shuffled, or they come in runs along a curve whose order or
// direction is mixed. True for points in order along one curve, however noisy, coarse or uneven,
// with gaps, crossings, or up to a third of gross outliers in between. Up to 5 points are always in
// order.
//
// In any order along a curve few points are nearer to a point than its successor is, shuffled half
// of them are; and where a long step leaves a run of near points, no point from elsewhere in the
// order takes the run on. Both are looked at for samples from a fixed seed.
// Not told from points in order: an open curve whose second part comes before its first (a closed
// one with a gap), and two branches interleaved (points sorted by a coordinate). O(m).
bool FollowsCurve(const Eigen::Matrix3Xd& points);

}  // namespace batten::internal
