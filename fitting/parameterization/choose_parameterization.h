// SPDX-License-Identifier: MIT
// Choice of the base that a cloud's parameters are taken from.
#pragma once

#include <string>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/fit_report.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

struct ParameterizationChoice {
  Parameterization base;
  PointMask reached;  // points the base has a place for
  std::vector<std::string> warnings;
  std::vector<BaseCandidate> candidates = {};  // all that were considered
  bool fits_noise = true;  // it predicts left-out points within their noise, or fits at once
};

// Chooses the base of a cloud: a plane if the points are a height field that is nowhere steep.
// Otherwise the sheet is flattened, and cross-validation chooses between both: the plane, unless
// the sheet is clearly better. A plane over which the points lie in layers here and there is taken
// with a warning if no other base serves. A cloud that cannot be flattened, or only with much
// distortion, is tried as a closed shape (FindClosedBases). If options.base asks for a base, that
// one is taken or none. Outliers of the statistics are left out of the choice, but get parameters.
// Throws std::invalid_argument, with a sentence for the user, if no base serves.
ParameterizationChoice ChooseBase(const PointCloud& points,
                                  const NeighbourIndex& index,
                                  const CloudStatistics& statistics,
                                  const SurfaceFitOptions& options,
                                  ThreadPool& pool);

}  // namespace batten::internal
