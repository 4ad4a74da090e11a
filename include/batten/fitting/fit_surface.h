// SPDX-License-Identifier: MIT
// NURBS surface fitting to measured points: the main entry point.
#pragma once

#include "batten/fitting/point_cloud.h"
#include "batten/fitting/surface_options.h"

namespace batten {

// Fits a surface to a cloud from its points alone: sets outliers aside, parameterizes over a plane
// or by flattening the bent sheet, chooses the knot grid by cross-validation, removes knot lines
// that do not pay, weighs fairness relative to the data, reweights robustly where there are
// outliers, refines where a tolerance is given, regularizes data gaps, and optimizes control points
// and parameters jointly where it pays. Of 200 000 points or more without outliers or gaps these
// stages see a sample and sums over small places, of which the answer is the same. Throws
// std::invalid_argument when the points can't carry a surface (fewer than four, on a line, on two
// sheets, in several parts, on a shape that is closed or one-sided), with a sentence for the user;
// Cancelled when progress stops it before there is a surface.
SurfaceFit FitSurface(const PointCloud& cloud, const SurfaceFitOptions& options = {});

}  // namespace batten
