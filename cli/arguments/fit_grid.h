// SPDX-License-Identifier: MIT
// `batten fit surface --grid`: points in rows and columns.
#pragma once

#include <string>

#include "batten/fitting/fit_grid.h"
#include "batten/fitting/fit_surface.h"
#include "cli/arguments/fit_arguments.h"

namespace batten::internal {

// Rows and columns "N,M", and how the grid is met: auto, interpolate, local, least-squares. Of the
// options of a surface fit those that a grid has are taken. Throws UsageError.
GridFitOptions ToGridOptions(const std::string& grid,
                             const std::string& method,
                             const SurfaceFitOptions& options);

// Fits the cloud of the files, whose rows that are not finite are cells without a point, and writes
// everything. `given`: rows and columns at the cloud's own u and v. Returns the exit code.
int RunGridFit(FitFiles& files, GridFitOptions options, bool given);

}  // namespace batten::internal
