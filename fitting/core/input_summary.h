// SPDX-License-Identifier: MIT
// What a report says of the points of a fit.
#pragma once

#include "batten/fitting/fit_report.h"
#include "batten/fitting/point_cloud.h"

namespace batten::internal {

// Number and box of a cloud's points, beside what was found out about them.
inline InputSummary SummariseInput(const PointCloud& cloud,
                                   Eigen::Index duplicates,
                                   double spacing,
                                   double noise) {
  InputSummary input;
  input.points = cloud.size();
  input.duplicates = duplicates;
  input.spacing = spacing;
  input.noise = noise;
  input.origin = cloud.origin();
  input.box_min = cloud.origin() + cloud.points().rowwise().minCoeff();
  input.box_max = cloud.origin() + cloud.points().rowwise().maxCoeff();
  return input;
}

}  // namespace batten::internal
