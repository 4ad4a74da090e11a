// SPDX-License-Identifier: MIT
// The surface fit that looks at every point in every stage.
#pragma once

#include "batten/fitting/surface_options.h"
#include "fitting/core/stage_clock.h"

namespace batten::internal {

// As FitSurface, whose options are checked; without the report's seconds.
SurfaceFit FitInMemory(const PointCloud& cloud,
                       const SurfaceFitOptions& options,
                       StageClock& clock);

}  // namespace batten::internal
