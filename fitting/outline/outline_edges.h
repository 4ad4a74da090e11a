// SPDX-License-Identifier: MIT
// Alignment of outlines with the edges and seams of their parameter rectangle. Lengths are in
// spacings; the rectangle reaches from zero to `sides`.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/outline_options.h"
#include "fitting/neighbours/local_spacing.h"
#include "fitting/outline/outline_loop.h"
#include "fitting/outline/outline_spline.h"

namespace batten::internal {

// Whether an outer border is nowhere deeper than four local spacings from the rectangle. Borders of
// random points are by chance deeper than that once in some 10^8 spacings of their length.
bool FillsRectangle(const OutlineLoop& outer,
                    const LocalSpacing& spacing,
                    const Eigen::Vector2d& sides);

// Moves stretches between corners that are nowhere far, by the spacing there, from an edge exactly
// onto it, up to the rectangle's corners; not those that a pin holds.
void PutOnEdges(OutlineLoop& loop,
                const std::vector<OutlinePin>& pins,
                const LocalSpacing& spacing,
                const Eigen::Vector2d& sides);

// Gives corners cut by a seam the same height on both sides of it.
void MatchSeam(std::vector<OutlineLoop>& loops, int axis, double period);

// Fixes straight pieces; their ends may still move along an edge.
void FixOnEdges(OutlineSpline& spline);

// Matches the ends of smoothed borders across seams: both take the outer of the two heights and are
// fixed. Returns whether any end was moved.
bool MatchSeams(std::vector<OutlineSpline>& splines,
                const OutlineOptions& options,
                const Eigen::Vector2d& sides);

// Moves a spline that leaves the rectangle a little back into it.
void KeepInRectangle(OutlineSpline& spline, const Eigen::Vector2d& sides);

// The rectangle as an outline.
OutlineSpline RectangleSpline(const Eigen::Vector2d& sides);

}  // namespace batten::internal
