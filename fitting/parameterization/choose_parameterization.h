// SPDX-License-Identifier: MIT
// Which base a cloud's parameters are taken from.
#pragma once

#include <string>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

struct ParameterizationChoice {
  Parameterization base;
  PointMask reached;  // points the base has a place for
  std::vector<std::string> warnings;
};

// A plane where the points are a height field that is nowhere steep. Otherwise the sheet is laid
// out flat, and the base over which left-out points are predicted better is taken, the plane unless
// the sheet is clearly better; a plane over which the points lie in layers here and there is taken
// with a warning if nothing else serves. What cannot be laid out flat, or only with lengths that
// differ much, is tried as a shape that closes (FindClosedBases). With options.base that base or
// none. Points that stand out by the statistics don't take part, but get their places. Throws
// std::invalid_argument, with a sentence for the user, where no base serves.
ParameterizationChoice ChooseBase(const PointCloud& points,
                                  const NeighbourIndex& index,
                                  const CloudStatistics& statistics,
                                  const SurfaceFitOptions& options,
                                  ThreadPool& pool);

}  // namespace batten::internal
