// SPDX-License-Identifier: MIT
// What the search for an outline is told of the points and of their parameter rectangle.
#pragma once

#include <functional>

namespace batten {

// All lengths are those of the parameters.
struct OutlineOptions {
  double spacing = 0;  // h > 0: the mean spacing of points, √(area / count)
  double noise = 0;  // ≥ 0: standard deviation of the parameters; detail below it is not followed
  bool periodic_u = false, periodic_v = false;  // the parameter lives on a circle
  double length_u = 1, length_v = 1;            // > 0
  bool pole_start = false, pole_end = false;    // the edge v = 0, v = length_v is one point
  // How long a unit of u is in space at v, about a pole; one where not given. Near a pole a point
  // stands for a longer part of its row.
  std::function<double(double)> stretch_u = nullptr;
};

}  // namespace batten
