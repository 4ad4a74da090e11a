// SPDX-License-Identifier: MIT
// How far measured points stand off a surface, as a field over it: one number for each place.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/thread_pool.h"

namespace batten {

// The signed deviation at every place (3 × n, a mesh's vertices), from the points' feet on the
// surface (3 × m) and their signed distances (m): a robust mean over the nearest feet, at most 16
// and none farther than `reach`, near ones counting most. One outlier among them moves it
// little or not at all; a constant comes back as it is. NaN where no foot lies within reach: no
// points were measured there. Feet and distances that are not finite do not count.
// Feet are near in space, not along the surface: where two sheets of it lie within reach of each
// other, both are seen. A few spacings of the points are a good reach.
// Places and feet are in one frame, wherever its origin. The same on any number of threads.
// O((m + n) log m): some 2 µs for a place. Throws std::invalid_argument unless there is one
// distance for every foot, reach > 0 and the places are finite. [the mean: Beaton & Tukey 1974]
Eigen::VectorXd DeviationMap(const Eigen::Matrix3Xd& places,
                             const Eigen::Matrix3Xd& feet,
                             const Eigen::VectorXd& signed_distances,
                             double reach,
                             ThreadPool& pool);

}  // namespace batten
