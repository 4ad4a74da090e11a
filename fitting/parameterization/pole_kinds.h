// SPDX-License-Identifier: MIT
// Kinds of the poles of a base, smooth or apex, from the points.
#pragma once

#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/base_score.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// Classifies the poles of a base as kSmooth or kApex: a pole is an apex if that explains the points
// under a mask better than by chance, and if the cone there is clearly no plane. Costs one linear
// fit for each pole and one more, over the grid the score chose.
Poles PolesByData(const Parameterization& base,
                  const PointCloud& points,
                  const PointMask& mask,
                  const BaseScore::Value& grid,
                  ThreadPool& pool);

}  // namespace batten::internal
