// SPDX-License-Identifier: MIT
// The bases of shapes that close on themselves: spheres, tori, surfaces of revolution and tubes.
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

// Points and what is known of them; everything is referred to, not copied.
struct GoodPoints {
  const Eigen::Matrix3Xd& points;  // those that do not stand out
  const NeighbourIndex& index;
  const CloudStatistics& statistics;
  double margin;
  const PoissonDiskSamples* nodes =
      nullptr;  // of them, as SamplePoissonDisk gives by default, if known
};

struct ClosedBase {
  Parameterization base;  // parameters of the good points
  PointMask reached;      // of them, those the base has a place for
};

struct ClosedBases {
  std::vector<ClosedBase> serving;  // the simplest first; none where there is a refusal
  std::string failure_reason;       // of what was asked for, with what to do
};

// The bases that serve, asked for or (kAuto) all in question: a sphere or torus where the points
// are near one, else the surface of revolution they are, and with `tubes` the tube they lie on
// where they are not clearly that.
ClosedBases FindClosedBases(const GoodPoints& good,
                            const SurfaceFitOptions& options,
                            bool tubes,
                            ThreadPool& pool);

}  // namespace batten::internal
