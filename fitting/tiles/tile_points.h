// SPDX-License-Identifier: MIT
// Points that pass by, folded into moments over the cells of a net.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "fitting/streaming/stream_pipeline.h"
#include "fitting/tiles/tile_axis.h"
#include "fitting/tiles/tile_system.h"

namespace batten::internal {

// The rectangle of parameters of all points near a surface.
struct TileDomain {
  Parameterization base;  // of that rectangle; its parameters are of no points
  Eigen::Vector2d shift;  // of its parameters from those of the near surface
  double limit;           // the distance at which outliers begin
};

// Passes over the points to find it, with a margin of half a spacing beside noise.
TileDomain FindDomain(StreamPipeline& pipeline,
                      const NearSurface& near,
                      const SurfaceFitOptions& options,
                      ThreadPool& pool);

// Passes over the points: heights over a plane, else the points themselves, at their parameters,
// into moments over the finest cells.
FoldedPoints FoldPoints(StreamPipeline& pipeline,
                        const NearSurface& near,
                        const TileDomain& domain,
                        const SplineBasis& basis_u,
                        const SplineBasis& basis_v,
                        ThreadPool& pool);

}  // namespace batten::internal
