// SPDX-License-Identifier: MIT
// Bases of closed shapes: spheres, tori, surfaces of revolution and tubes.
#pragma once

#include <string>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/flattening/poisson_disk_samples.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// The inliers of a cloud with their index and statistics; everything is referred to, not copied.
struct GoodPoints {
  const Eigen::Matrix3Xd& points;  // the inliers
  const NeighbourIndex& index;
  const CloudStatistics& statistics;
  double margin;
  const PoissonDiskSamples* nodes =
      nullptr;  // their Poisson-disk samples by default options, if known
};

struct ClosedBase {
  Parameterization base;  // parameters of the good points
  PointMask reached;      // inliers that the base has a place for
};

struct ClosedBases {
  std::vector<ClosedBase> serving;  // the simplest first; none if there is a failure reason
  std::string failure_reason;       // why the base asked for does not serve, and what to do
};

// Finds the closed bases that serve, either the one asked for or (kAuto) all candidates: a sphere
// or torus if the points are near one, else a surface of revolution, and with `tubes` a tube unless
// the points are clearly a surface of revolution.
ClosedBases FindClosedBases(const GoodPoints& good,
                            const SurfaceFitOptions& options,
                            bool tubes,
                            ThreadPool& pool);

}  // namespace batten::internal
