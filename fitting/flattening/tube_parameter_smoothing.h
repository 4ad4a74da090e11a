// SPDX-License-Identifier: MIT
// Smoothing of a flattened tube's parameters by the chart of a surface fitted over them.
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

// Smooths the parameters of a tube. Flattening leaves small wrinkles, which a surface over the
// parameters must follow with cells of their size. A smooth surface with as few cells as leave
// residuals not much larger than the finest ones do is therefore fitted to the points under the
// mask, and the foot points on it become parameters by the surface's own chart; this is done twice.
// If the surface has no chart, or one that folds or distorts lengths by more than
// `most_distortion`, the parameters are left unchanged. O(m).
TubeParameters SmoothTubeParameters(TubeParameters tube,
                                    const Eigen::Matrix3Xd& points,
                                    const PointMask& mask,
                                    double most_distortion,
                                    ThreadPool& pool);

}  // namespace batten::internal
