// SPDX-License-Identifier: MIT
// The base of a cloud that has clutter, supports or stray points beside it.
#pragma once

#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/constraints/conditioned_base.h"

namespace batten::internal {

struct BaseBesideClutter {
  ConditionedBase base;
  // SmallParts that were set aside; empty: none were.
  std::vector<int> set_aside;
};

// Chooses a base as ChooseConditionedBase does. Where there are small parts beside a large one that
// are no heights beside the others over the base's plane, as islands are, or no plane fits within
// the noise, it is also chosen without them: they can decide what it looks like and lie on no sheet
// of it. That is taken where the other was refused, or where it fits within the noise: they are
// outliers of `statistics` then, without a place. With `keep_all` nothing is set aside. Throws as
// the former.
BaseBesideClutter ChooseBesideClutter(const PointCloud& cloud,
                                      const NeighbourIndex& index,
                                      const SurfaceFitOptions& options,
                                      bool keep_all,
                                      ThreadPool& pool,
                                      CloudStatistics& statistics);

}  // namespace batten::internal
