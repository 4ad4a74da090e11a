// SPDX-License-Identifier: MIT
// What a surface fit makes of a cloud before it fits anything.
#pragma once

#include <cstdint>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/plane_base.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

// The cloud as the later stages see it.
struct PreparedCloud {
  MergedCloud merged;  // neighbours in the plane are neighbours in memory
  CloudStatistics statistics;
  PlaneBase base;
  PointMask used;           // of the merged points: those the fit rests on
  double base_seconds = 0;  // that finding the base took
};

struct PreparationOptions {
  bool keep_outliers = false;
  std::uint64_t seed = 1;  // chooses samples
};

// Merges duplicates, measures spacing and noise, flags outliers, finds the base, and sorts the
// points by place. Throws std::invalid_argument with a sentence for the user where there are fewer
// than four different points or all lie on a line; Cancelled when progress asks to stop. O(m log
// m).
PreparedCloud PrepareCloud(const PointCloud& cloud,
                           const PreparationOptions& options,
                           ThreadPool& pool,
                           const Progress& progress = {});

}  // namespace batten
