// SPDX-License-Identifier: MIT
// Preparation of a cloud for a surface fit: duplicates, statistics, outliers, parameterization.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/fit_report.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/constraints/conditioned_base.h"
#include "fitting/constraints/symmetric_cloud.h"
#include "fitting/core/stage_clock.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// The share of outliers among the points above which fits are robust; below it lies what the
// outlier test flags on clean data.
inline constexpr double kOutlierShareForLoss = 2e-3;

// The reflection symmetry of a cloud that is its own mirror image.
struct CloudSymmetry {
  MirrorPlane plane;                    // relative to the cloud's origin
  std::vector<Eigen::Index> twins;      // of every point of the cloud as given
  Direction reflected = Direction::kU;  // the direction of the base that mirrors itself
};

// The cloud as the later stages see it: merged, sorted, parameterized, with its inliers.
struct PreparedCloud {
  MergedCloud merged;  // neighbours in the base are neighbours in memory
  CloudStatistics statistics;
  Parameterization base;
  SurfaceConditions conditions;
  std::optional<CloudSymmetry> symmetry;
  PointMask reached;  // mask of the merged points: parameterized by the base
  PointMask used;     // mask of the merged points: initial inliers
  // SmallParts that were set aside before the base was chosen; empty: none were.
  std::vector<int> set_aside;
  std::vector<std::string> warnings;
  std::vector<BaseCandidate> candidates;  // for the base
};

// Merges duplicates, measures spacing and noise, flags outliers, finds the base, and sorts the
// points by place. Throws std::invalid_argument with a sentence for the user where there are fewer
// than four different points, all lie on a line, or no base covers them; Cancelled when progress
// asks to stop. With `symmetry` the base is made symmetric. O(m log m).
PreparedCloud PrepareCloud(const PointCloud& cloud,
                           const SurfaceFitOptions& options,
                           ThreadPool& pool,
                           StageClock& clock,
                           std::optional<CloudSymmetry> symmetry = std::nullopt);

// Sorts points so that neighbours in the base are neighbours in memory, because later stages visit
// them cell by cell.
void SortByPlace(PreparedCloud& prepared);

// The report as it is before a fit over prepared points, made of `cloud`.
FitReport StartReport(const PreparedCloud& prepared,
                      const PointCloud& cloud,
                      Eigen::Index duplicates,
                      int threads);

}  // namespace batten::internal
