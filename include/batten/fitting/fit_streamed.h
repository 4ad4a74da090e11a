// SPDX-License-Identifier: MIT
// Surface fits of clouds that need not fit in memory.
#pragma once

#include "batten/fitting/point_source.h"
#include "batten/fitting/stream_options.h"
#include "batten/fitting/surface_options.h"

namespace batten {

// Fits a surface as FitSurface does, holding of many points only a sample and sums over places. A
// cloud that fits in the memory allowed (200 bytes a point) is fitted by FitSurface itself. Else
//  1. one pass counts, measures the box and keeps a sample: the points of least hash of their
//     coordinates, so that neither order nor parts matter. [Cohen & Kaplan 2007, bottom-k sketches]
//  2. the fit of the sample gives the base and a surface near all points;
//  3. a pass gives every point its parameters, those of its foot on that surface (over a plane:
//     its coordinates there), and sums numbers, parameters and distances from it over small places
//     of the domain. A place stands for its points: as the surface is near, what differs is of
//     second order in a small difference. [Wood et al. 2017, on discretised covariates]
//  4. degrees of freedom and coefficients are chosen over the places, weighted by their points, as
//     FitSurface chooses them over points. Passes 3 and 4 are repeated with the new surface while
//     it needs finer places, or where there are outliers, three times at most;
//  5. a last pass measures every point.
// Points farther off than the sample's outliers begin have no weight, unless several of a place
// are equally far. Memory: 100 bytes a control point times the places to each, which are 40 or
// more; not the number of points. Time: some 0.3 µs a point and pass.
//
// The options as in FitSurface; no joint stage. Throws std::invalid_argument for boundary, meet,
// symmetric, domain, thin, snap, optimize, terms, given_parameters, side_of_normals and smooth_by,
// which need all points at once, and as FitSurface does.
StreamedFit FitStreamed(PointSource& source,
                        const SurfaceFitOptions& options = {},
                        const StreamOptions& stream = {});

}  // namespace batten
