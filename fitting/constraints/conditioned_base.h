// SPDX-License-Identifier: MIT
// The parameterization of a surface that meets curves and points exactly.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/constraints/coons_parameterization.h"
#include "fitting/constraints/surface_constraints.h"
#include "fitting/parameterization/choose_parameterization.h"

namespace batten::internal {

// The interpolation conditions of a surface over a base, in the cloud's local coordinates.
struct SurfaceConditions {
  std::vector<PlacedBoundary> sides;
  std::vector<FixedPoint> points;
  bool any() const { return !sides.empty() || !points.empty(); }
};

// Converts the conditions to constraints of the linear stage, tangent planes of neighbours
// included.
SurfaceConstraints ConstraintsOf(const SurfaceConditions& conditions);

struct ConditionedBase {
  ParameterizationChoice choice;
  SurfaceConditions conditions;
};

// Runs ChooseBase on the points together with samples of the curves of options.boundary and the
// points of options.meet, which then get parameters in the base; the edges of the rectangle are the
// curves. A sheet without boundary curves ends in the points' own outline where that is nearly a
// rectangle; with options.domain the rectangle is that domain. Throws as ChooseBase, and where a
// condition cannot be placed.
ConditionedBase ChooseConditionedBase(const PointCloud& points,
                                      const NeighbourIndex& index,
                                      const CloudStatistics& statistics,
                                      const SurfaceFitOptions& options,
                                      ThreadPool& pool);

}  // namespace batten::internal
