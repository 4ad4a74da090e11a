// SPDX-License-Identifier: MIT
// The nearest of several surfaces.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Of every point, as DistancesTo has it.
struct NearestSurfaces {
  std::vector<int> surface;  // its number
  Eigen::VectorXd distances;
  Eigen::Matrix2Xd parameters;
};

// There is a surface. Those whose control points' box is farther than what is found are passed
// over.
NearestSurfaces NearestOf(const std::vector<NurbsSurface>& surfaces,
                          const Eigen::Matrix3Xd& points,
                          ThreadPool& pool);

}  // namespace batten::internal
