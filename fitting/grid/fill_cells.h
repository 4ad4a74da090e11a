// SPDX-License-Identifier: MIT
// Fills missing cells of a grid by minimising the discrete thin-plate energy.
#pragma once

#include "batten/fitting/grid_data.h"
#include "batten/fitting/grid_parameters.h"

namespace batten::internal {

// The grid with a point in every cell: measured points stay, the others minimise the discrete
// thin-plate energy, Σ of squared second differences along u, along v and, twice, across, divided
// by the parameters' steps and weighted with cells' areas. The fill continues the points on either
// side of a data gap smoothly, and points that are linear in the parameters exactly. `parameters`
// are of the lines, in lengths. Directions that close are taken as open. O(gaps^1.5). Throws
// std::invalid_argument where no more than two points are left, or all of them in one line.
PointNet WithFilledCells(const PointNet& net, const GridParameters& parameters);

}  // namespace batten::internal
