// SPDX-License-Identifier: MIT
// Sample points with normals estimated from their neighbours, where these look like a surface. Used
// by the surface starts only.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Points projected onto the planes fitted to their neighbours, and unit normals without a
// consistent sign.
struct OrientedPoints {
  Eigen::Matrix3Xd points, normals;
};

// Some of the points of a sample (3 × m), with normals from neighbourhoods of several widths: small
// ones follow bends, wide ones average noise. Points whose neighbourhood is sparser or less flat
// than usual are dropped; most of them are outliers. Empty for fewer than eight points. O(m log m).
std::vector<OrientedPoints> OrientedSamples(const Eigen::Matrix3Xd& points,
                                            std::uint64_t seed,
                                            ThreadPool& pool);

}  // namespace batten::internal
