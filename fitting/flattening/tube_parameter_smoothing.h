// SPDX-License-Identifier: MIT
// Smooth coordinates of a tube from those of its nodes.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct TubeParameters {
  Eigen::Matrix2Xd parameters;  // (u, v), u in [0, length_u), v in [0, length_v]
  double length_u, length_v;
  double distortion;  // of lengths, relative: root mean square
};

// Laying out nodes leaves small wrinkles, which a surface over the parameters must follow with
// cells of their size. So a smooth surface of few cells, as few as leave residuals not much larger
// than the finest do, is fitted over them, and the feet of the points on it become parameters by
// the surface's own chart; then once more from there. A surface that has no chart, or one that
// folds or changes lengths by more than `most_distortion`, leaves the parameters as they are.
// Points under the mask make the surface. O(m).
TubeParameters SmoothTubeParameters(TubeParameters tube,
                                    const Eigen::Matrix3Xd& points,
                                    const PointMask& mask,
                                    double most_distortion,
                                    ThreadPool& pool);

}  // namespace batten::internal
