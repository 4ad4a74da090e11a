// SPDX-License-Identifier: MIT
// Parameters for the rows and columns of a grid of points, from where the points lie.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/grid_data.h"

namespace batten {

enum class GridParameterization {
  kAuto,         // places in the plane where the grid is regular over one, else kChord
  kGiven,        // the caller's, in their own range
  kUniform,      // equal steps on [0, 1]
  kChord,        // steps in proportion to the distance of neighbours, on [0, 1], the mean over rows
  kCentripetal,  // to its square root
};

// The word reports use, as in "chord".
const char* Name(GridParameterization parameterization);

// One value a row (u) and one a column (v), increasing.
struct GridParameters {
  Eigen::VectorXd u, v;
};

struct GridClosing {
  bool u = false, v = false;
};

// Those of its collapsed lines that are edges: ends of directions that do not close.
CollapsedLines PolesOf(const PointNet& net, const GridClosing& closed);

// The parameters of a grid on [0, 1]². A direction that closes goes on from its last line to the
// first and has one value more, 1, the first one's again. Distances are means over the lines across
// that have a length (a pole row has none), each scaled to its whole. Cells that are missing are
// left out: a step is then the mean over the lines that have both its ends. A grid is regular over
// a plane where, seen along some direction, its rows and its columns are straight and parallel to a
// thousandth of a step.
// Throws std::invalid_argument, with a sentence for the user, where neighbouring lines lie in one
// place or share no cells, and for kGiven. O(rows·columns).
// [Piegl & Tiller 1997, A9.3]
GridParameters ParametersOf(const PointNet& net,
                            GridParameterization parameterization,
                            const GridClosing& closed = {});

// The mean lengths of the lines along u and along v, from point to point.
Eigen::Vector2d MeanLengths(const PointNet& net, const GridClosing& closed = {});

// Those, or the given ones after CheckParameters.
GridParameters ParametersFor(const PointNet& net,
                             GridParameterization parameterization,
                             const GridParameters& given,
                             const GridClosing& closed = {});

// Throws std::invalid_argument unless given parameters have the right number and increase.
void CheckParameters(const PointNet& net,
                     const GridParameters& parameters,
                     const GridClosing& closed);

}  // namespace batten
