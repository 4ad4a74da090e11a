// SPDX-License-Identifier: MIT
// Monotone functions through given values.
#pragma once

#include <vector>

#include "geometry/construction/cubic_approximation.h"
#include "geometry/construction/curves_together.h"

namespace batten::internal {

// An increasing cubic spline from [0, 1] onto itself with f(places[k]) = values[k]: the C^2 spline
// where that increases, else the one with slopes of Fritsch and Carlson, C^1. [Fritsch & Carlson
// 1980, "Monotone piecewise cubic interpolation"]
class MonotoneMap {
 public:
  // Both lists increase from 0 to 1. A `cyclic` map has the same slope at both ends, and where it
  // is C^2 the same curvature.
  MonotoneMap(std::vector<double> places, std::vector<double> values, bool cyclic);

  Retracing At(double s, Side side) const;  // value and slope
  double InverseAt(double value) const;
  int continuity() const { return continuity_; }  // at the places

 private:
  std::vector<double> places_, values_, slopes_;
  int continuity_;
};

}  // namespace batten::internal
