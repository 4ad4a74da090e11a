// SPDX-License-Identifier: MIT
// Missing cells of a grid, filled fairly.
#pragma once

#include "batten/fitting/grid_data.h"
#include "batten/fitting/grid_parameters.h"

namespace batten::internal {

// The grid with a point in every cell: those that are there stay, the others make the discrete
// thin-plate energy least, Σ of squared second differences along u, along v and, twice, across,
// divided by the parameters' steps and weighted with cells' areas. So the points on either side of
// a gap go on into it as smoothly as they can, and what is linear in the parameters is continued
// exactly. `parameters` are of the lines, in lengths. Directions that close are taken as open.
// O(gaps^1.5). Throws std::invalid_argument where no more than two points are left, or all of
// them in one line.
PointNet WithFilledCells(const PointNet& net, const GridParameters& parameters);

}  // namespace batten::internal
