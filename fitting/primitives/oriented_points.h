// SPDX-License-Identifier: MIT
// Points with the normals of their surroundings, where these are like a surface. Used by the starts
// of surfaces only.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Points put on the planes through their neighbours, and unit normals without a consistent sign.
struct OrientedPoints {
  Eigen::Matrix3Xd points, normals;
};

// Some of the points of a sample (3 × m), with normals at a few widths: small ones follow bends,
// wide ones average noise. Left out is what stands in surroundings emptier or less flat than is
// usual: outliers, for the most part. No widths where there are fewer than eight points.
// O(m log m).
std::vector<OrientedPoints> OrientedSamples(const Eigen::Matrix3Xd& points,
                                            std::uint64_t seed,
                                            ThreadPool& pool);

}  // namespace batten::internal
