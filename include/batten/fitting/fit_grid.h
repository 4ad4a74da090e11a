// SPDX-License-Identifier: MIT
// Fits a NURBS surface to points measured in rows and columns.
#pragma once

#include "batten/fitting/grid_options.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/surface_options.h"

namespace batten {

// Fits the surface over the grid's own parameters, in lengths (given ones in their own range):
// global or local interpolation, least squares with the control points given, or approximation with
// as few as are found to keep the tolerance, between the points too: the interpolant itself is the
// result where fewer control points do not suffice. Neighbouring lines that agree exactly are
// merged, with a warning; missing cells are filled by least thin-plate energy beforehand and do not
// count in the errors. Distances are orthogonal, from the foot points near the grid's own
// parameters. Throws std::invalid_argument, with a sentence for the user, where the cloud does not
// hold one point for each cell, or the points carry no surface; Cancelled when progress stops it.
SurfaceFit FitGrid(const PointCloud& cloud, const GridFitOptions& options);

}  // namespace batten
