// SPDX-License-Identifier: MIT
// The options of FindOutline: spacing and noise of the points, and their parameter rectangle.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace batten {

// Options of FindOutline; all lengths are in parameter units.
struct OutlineOptions {
  double spacing = 0;  // h > 0: the mean spacing of points, √(area / count)
  double noise = 0;  // ≥ 0: standard deviation of the parameters; detail below it is not followed
  bool periodic_u = false, periodic_v = false;  // the direction is periodic
  double length_u = 1, length_v = 1;            // > 0
  bool pole_start = false, pole_end = false;    // the edge v = 0, v = length_v is one point
  // The length in space of a unit of u at height v, for surfaces with poles; 1 where not given.
  // Near a pole a point stands for a longer part of its row.
  std::function<double(double)> stretch_u = nullptr;
  // The place in space of parameters inside the rectangle, for maps that stretch what lies between
  // points: gaps are then measured in space. The parameters themselves where not given.
  std::function<Eigen::Vector3d(const Eigen::Vector2d&)> place = nullptr;
};

}  // namespace batten
