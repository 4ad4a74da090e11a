// SPDX-License-Identifier: MIT
// Deviation map: the signed distance of measured points from a surface, as a field over it.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/thread_pool.h"

namespace batten {

// Interpolates the signed deviation at every place (3 × n, a mesh's vertices) from the foot points
// of the cloud on the surface (3 × m) and their signed distances (m): Tukey's biweight mean over at
// most 16 nearest foot points within `reach`, the nearer ones with more weight. One outlier among
// them moves it little or not at all; a constant field is reproduced. The result is NaN where no
// foot point lies within reach: no points were measured there. Foot points and distances that are
// not finite are ignored.
// Nearness is measured in space, not along the surface: where two sheets of the surface lie within
// reach of each other, both contribute. A few point spacings are a good reach.
// Places and foot points share one frame with any origin. The same on any number of threads.
// O((m + n) log m): some 2 µs for a place. Throws std::invalid_argument unless there is one
// distance for every foot, reach > 0 and the places are finite. [the mean: Beaton & Tukey 1974]
Eigen::VectorXd DeviationMap(const Eigen::Matrix3Xd& places,
                             const Eigen::Matrix3Xd& feet,
                             const Eigen::VectorXd& signed_distances,
                             double reach,
                             ThreadPool& pool);

}  // namespace batten
