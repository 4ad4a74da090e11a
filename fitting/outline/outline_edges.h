// SPDX-License-Identifier: MIT
// Outlines against the edges of their parameter rectangle, whose seams close. Lengths in spacings;
// the rectangle reaches from zero to `sides`.
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

// Stretches between corners that are nowhere far from an edge run along it exactly, to the
// rectangle's corners.
void PutOnEdges(OutlineLoop& loop, const Eigen::Vector2d& sides);

// Corners cut by a seam are at one height on either side of it.
void MatchSeam(std::vector<OutlineLoop>& loops, int axis, double period);

// Straight pieces stay where they are; their ends may move along an edge.
void FixOnEdges(OutlineSpline& spline);

// The same for what was smoothed: of two ends that belong together the outer one counts, and is
// fixed. Whether any was moved.
bool MatchSeams(std::vector<OutlineSpline>& splines,
                const OutlineOptions& options,
                const Eigen::Vector2d& sides);

// A spline that leaves the rectangle a little is squeezed into it.
void KeepInRectangle(OutlineSpline& spline, const Eigen::Vector2d& sides);

// The rectangle itself.
OutlineSpline RectangleSpline(const Eigen::Vector2d& sides);

}  // namespace batten::internal
