// SPDX-License-Identifier: MIT
// The base of a cloud that has clutter, supports or stray points beside it.
#pragma once

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/constraints/conditioned_base.h"

namespace batten::internal {

// Chooses a base as ChooseConditionedBase does. Where none fits within the noise, it is also chosen
// without small parts beside a large one, which can decide what it looks like and lie on no sheet
// of it. That is taken where the other was refused, or where it fits within the noise and the small
// parts are no heights beside the others, such as islands: they are outliers of `statistics` then,
// without a place. With `keep_all` nothing is set aside. Throws as the former.
ConditionedBase ChooseBesideClutter(const PointCloud& cloud,
                                    const NeighbourIndex& index,
                                    const SurfaceFitOptions& options,
                                    bool keep_all,
                                    ThreadPool& pool,
                                    CloudStatistics& statistics);

}  // namespace batten::internal
