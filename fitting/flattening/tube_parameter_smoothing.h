// SPDX-License-Identifier: MIT
// Smoothing of a flattened tube's parameters by the chart of a surface fitted over them.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/thread_pool.h"
#include "fitting/flattening/flattened_base.h"

namespace batten::internal {

// Smooths the parameters of a tube. Flattening leaves small wrinkles, which a surface over the
// parameters must follow with cells of their size. A smooth surface with as few cells as leave
// residuals not much larger than the finest ones do is therefore fitted to the points reached, and
// the foot points on it become parameters by the surface's own chart; this is done twice. If the
// surface has no chart, or one that folds or distorts lengths by more than kFlatteningLimits, the
// base is left unchanged. O(m).
void SmoothTubeParameters(const Eigen::Matrix3Xd& points, ThreadPool& pool, FlattenedBase& base);

}  // namespace batten::internal
