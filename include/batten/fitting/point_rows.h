// SPDX-License-Identifier: MIT
// Scattered points with parameters, as plain memory.
#pragma once

#include <cstddef>

namespace batten {

// Point k has the parameters outer[k·stride] and inner[k·stride], `dimension` values from
// values[k·dimension] on, and weights[k]. A curve has no inner parameters (null); without weights
// (null) all are one. Whoever makes it keeps the memory alive.
struct PointRows {
  std::ptrdiff_t count;
  const double *outer, *inner;
  std::ptrdiff_t stride;
  const double* values;
  int dimension;
  const double* weights;
};

}  // namespace batten
