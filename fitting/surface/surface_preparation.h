// SPDX-License-Identifier: MIT
// What a surface fit makes of a cloud before it fits anything.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/constraints/conditioned_base.h"
#include "fitting/constraints/symmetric_cloud.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// Outliers beyond this share of the points call for robust fits: less is what the test for them
// flags on clean data.
inline constexpr double kOutlierShareForLoss = 2e-3;

// The cloud as the later stages see it.
// A cloud that is its own mirror image.
struct CloudSymmetry {
  MirrorPlane plane;                    // relative to the cloud's origin
  std::vector<Eigen::Index> twins;      // of every point of the cloud as given
  Direction reflected = Direction::kU;  // the direction of the base that mirrors itself
};

struct PreparedCloud {
  MergedCloud merged;  // neighbours in the base are neighbours in memory
  CloudStatistics statistics;
  Parameterization base;
  SurfaceConditions conditions;
  std::optional<CloudSymmetry> symmetry;
  PointMask reached;  // of the merged points: those the base has a place for
  PointMask used;     // of those: the ones the fit rests on at first
  std::vector<std::string> warnings;
  double base_seconds = 0;  // that finding the base took
};

// Merges duplicates, measures spacing and noise, flags outliers, finds the base, and sorts the
// points by place. Throws std::invalid_argument with a sentence for the user where there are fewer
// than four different points, all lie on a line, or no base covers them; Cancelled when progress
// asks to stop. `symmetry`: the base is to be symmetric. O(m log m).
PreparedCloud PrepareCloud(const PointCloud& cloud,
                           const SurfaceFitOptions& options,
                           ThreadPool& pool,
                           std::optional<CloudSymmetry> symmetry = std::nullopt);

// Puts points that are neighbours in the base beside each other in memory: everything later goes
// through them cell by cell.
void SortByPlace(PreparedCloud& prepared);

// Chooses the base anew where the points of the prepared ones that a fit has left out as outliers,
// all but those under `used`, had drawn its rectangle clearly too wide: outliers beyond an edge are
// told from the shape by a surface only. Returns whether it did; not where the rest
// carries no base. Throws Cancelled when progress asks to stop.
bool TakeSmallerBase(PreparedCloud& prepared,
                     const PointMask& used,
                     const SurfaceFitOptions& options,
                     ThreadPool& pool);

}  // namespace batten::internal
