// SPDX-License-Identifier: MIT
// Options of a fit to points in rows and columns.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>

#include "batten/fitting/grid_parameters.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/surface_options.h"

namespace batten {

enum class GridMethod {
  kAuto,  // within the tolerance, with the control points, or through all points: as options say
  kInterpolate,         // through all points
  kInterpolateLocally,  // through all points, bicubic and C¹, each acting on its neighbourhood only
  kLeastSquares,        // with the control points given
};

struct GridFitOptions {
  int rows = 0, columns = 0;  // the cloud is row after row, the points of a row one after the other
  int degree_u = 3, degree_v = 3;  // across rows, along rows; 1 … 25
  GridMethod method = GridMethod::kAuto;
  std::optional<double> tolerance = std::nullopt;  // distance in the data's units, > 0
  std::optional<std::pair<int, int>> control_points = std::nullopt;  // n_u, n_v: least squares
  GridParameterization parameterization = GridParameterization::kAuto;
  GridParameters parameters = {};   // for kGiven: one a row and one a column, increasing
  Closing closed = Closing::kAuto;  // kAuto: where the last line repeats the first
  // Of the rows·columns cells: those without a point, which the cloud then leaves out. Empty: none.
  PointMask missing = {};
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // subtracted from the coordinates of the result
  int threads = 0;                                  // 0: all cores
  Progress progress = nullptr;
};

// Throws std::invalid_argument naming the field whose value breaks its rule.
void Check(const GridFitOptions& options);

// The corresponding options of a surface fit, as far as these exist there.
SurfaceFitOptions AsSurfaceOptions(const GridFitOptions& options);

}  // namespace batten
