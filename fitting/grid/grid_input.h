// SPDX-License-Identifier: MIT
// Reads a cloud as a grid of rows and columns. Used by FitGrid only.
#pragma once

#include <string>
#include <vector>

#include "batten/fitting/grid_data.h"
#include "batten/fitting/grid_options.h"
#include "batten/fitting/grid_parameters.h"
#include "batten/fitting/point_cloud.h"

namespace batten::internal {

// The grid of a cloud, without repeated and empty lines.
struct GridInput {
  PointNet net;               // in the cloud's local coordinates
  GridParameters parameters;  // of its lines, in lengths (given ones as they are)
  GridClosing closed;
  std::vector<std::string> warnings;
  // The line of the net that stands for each row and column of the cloud; -1 where all its cells
  // are missing.
  std::vector<int> row_of, column_of;
  std::string parameters_from;
};

// The net of some of its rows, or columns.
PointNet WithLines(const PointNet& net, bool rows, const std::vector<int>& kept);

// Reads the grid from the cloud. Throws std::invalid_argument, with a sentence for the user that
// names sizes that would fit, where the cloud does not hold one point for every cell that is not
// missing.
GridInput ReadGrid(const PointCloud& cloud, const GridFitOptions& options);

}  // namespace batten::internal
