// SPDX-License-Identifier: MIT
// Regions of a cloud with settled borders, at the noise that their own points show.
#pragma once

#include <cstdint>
#include <optional>

#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/regions/grow_regions.h"

namespace batten::internal {

struct FoundRegions {
  RegionLabels labels;
  double sigma = 0;  // standard deviation of points about their region's shape
};

// `tolerance`: points so far from a shape are of it whatever the noise; 0: none. Lengths in the
// unit of the data. Points of narrow faces get normals of their own.
FoundRegions FindRegions(RegionPoints& data,
                         double tolerance,
                         const Progress& progress,
                         ThreadPool& pool);

}  // namespace batten::internal
