// SPDX-License-Identifier: MIT
// Options and results of fits to points that are passed over.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/point_source.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

struct StreamOptions {
  std::int64_t memory = std::int64_t{1} << 30;  // bytes the fit may take, ≥ 2^25
  Eigen::Index sample = 100000;                 // points kept, ≥ 1000
  PassStore* store = nullptr;                   // where finished passes are kept, if anywhere
};

// Throws std::invalid_argument naming the field whose value breaks its rule.
void Check(const StreamOptions& options);

struct StreamedFit {
  NurbsSurface surface;  // in world coordinates less options.shift
  FitReport report;      // measured on it, over all points
  // Points that stand for all: all of them where they fit in memory, else the sample; with their
  // foot points, signed distances, and whether they lie beyond the distance at which outliers begin
  PointCloud sample;
  Eigen::Matrix2Xd parameters;
  Eigen::VectorXd residuals;
  PointMask outliers;
  bool in_memory = false;  // the points were few: the fit is that of FitSurface
  int passes = 0;          // over the points
};

}  // namespace batten
