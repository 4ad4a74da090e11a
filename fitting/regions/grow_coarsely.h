// SPDX-License-Identifier: MIT
// Regions of clouds of many points, grown over few of these.
#pragma once

#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/regions/grow_regions.h"

namespace batten::internal {

// Grows regions over an evenly spread part of the points, with neighbours and normals among these
// alone; the others are of none: SettleRegions gives them theirs. All points where they are few.
// Noise that neighbours share, as depth cameras make it, is little alike among points farther
// apart.
RegionLabels GrowCoarsely(const RegionPoints& data,
                          double sigma,
                          const Progress& progress,
                          ThreadPool& pool);

}  // namespace batten::internal
