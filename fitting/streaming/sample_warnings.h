// SPDX-License-Identifier: MIT
// What a sample and all points together tell a user to look at.
#pragma once

#include <string>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/point_cloud.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/streaming/all_distances.h"

namespace batten::internal {

// Warns where far more points are beyond the limit than the sample has there: it may miss a part.
void WarnOfWhatTheSampleMisses(const AllDistances& all,
                               double count,
                               const PointMask& outliers_of_sample,
                               FitReport& report);

// Warns where the sample falls into parts that do not touch (FindCloudParts), with a hundredth of
// it each or more, and says where they are.
void WarnOfParts(const PointCloud& sample, ThreadPool& pool, FitReport& report);

}  // namespace batten::internal
