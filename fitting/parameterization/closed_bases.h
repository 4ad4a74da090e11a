// SPDX-License-Identifier: MIT
// The bases of shapes that close on themselves: spheres, tori, surfaces of revolution and tubes.
#pragma once

#include <string>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/surface_options.h"
#include "batten/fitting/neighbours.h"
#include "fitting/flattening/sheet_nodes.h"
#include "fitting/parameterization/surface_base.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Points and what is known of them; everything is referred to, not copied.
struct GoodPoints {
  const Eigen::Matrix3Xd& points;  // those that do not stand out
  const NeighbourIndex& index;
  const CloudStatistics& statistics;
  double margin;
  const SheetNodes* nodes = nullptr;  // of them, as ChooseSheetNodes gives by default, if known
};

struct ClosedBase {
  SurfaceBase base;   // parameters of the good points
  PointMask reached;  // of them, those the base has a place for
};

struct ClosedBases {
  std::vector<ClosedBase> serving;  // the simplest first; none where there is a refusal
  std::string refusal;              // of what was asked for, with what to do
};

// The bases that serve, asked for or (kAuto) all in question: a sphere or torus where the points
// are near one, else the surface of revolution they are, and with `tubes` the tube they lie on
// where they are not clearly that.
ClosedBases FindClosedBases(const GoodPoints& good,
                            const SurfaceFitOptions& options,
                            bool tubes,
                            ThreadPool& pool);

}  // namespace batten::internal
