// SPDX-License-Identifier: MIT
// A NURBS surface from measured points: the main job.
#pragma once

#include "batten/fitting/point_cloud.h"
#include "batten/fitting/surface_options.h"

namespace batten {

// Fits a surface to a cloud without being told anything but the points: outliers set aside, a plane
// base under the sheet or the bent sheet laid out flat, as many knot cells as cross-validation
// finds the data to carry, without the knot lines that do not pay, fairness relative to the data,
// robust reweighting where there are outliers, refinement where a tolerance asks for it, smooth where
// there are no points, and a joint optimisation of control points and parameters where it pays.
// Throws std::invalid_argument when the points can't carry a surface (fewer than four, on a line,
// on two sheets, in several parts, on a shape that is closed or one-sided), with a sentence for the
// user; Cancelled when progress stops it before there is a surface.
SurfaceFit FitSurface(const PointCloud& cloud, const SurfaceFitOptions& options = {});

}  // namespace batten
