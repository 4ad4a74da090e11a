// SPDX-License-Identifier: MIT
// Whether a surface has a tangent plane at its poles, by its points.
#pragma once

#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/base_score.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// The poles of a base, each kSmooth or kApex: an apex where that explains the points under a mask
// better than noise would, and where the cone there is clearly no plane. A linear fit for each pole
// and one more, over the grid the score chose.
Poles PolesByData(const Parameterization& base,
                  const PointCloud& points,
                  const PointMask& mask,
                  const BaseScore::Value& grid,
                  ThreadPool& pool);

}  // namespace batten::internal
