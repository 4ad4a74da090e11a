// SPDX-License-Identifier: MIT
// Local optimisation of free knots from one start. Used by the free-knot search only.
#pragma once

#include <functional>

#include "fitting/knots/variable_projection.h"

namespace batten::internal {

struct DescentOptions {
  int max_iterations = 100;
  double tolerance = 1e-10;              // stop when Φ falls by less than this share of itself
  double coalesce = 1e-6;                // of the domain: closer groups become one
  double stop_squares = 0;               // stop when Φ falls to this
  std::function<bool()> stop = nullptr;  // asked at every iteration; may be empty
};

struct Descent {
  MovingKnots knots;
  double cost = 0;  // Φ at the knots; infinite where the start determines no coefficients
  int iterations = 0;
};

// Minimises Φ by Ceres' Levenberg–Marquardt in the logarithms of the gaps, no step longer than 2 in
// any of them. When two groups come nearer than `coalesce` they are merged, as far as the degree
// allows, and the search goes on without the lost variable. Never worse than the start, except by
// what the merging of knots nearer than `coalesce` costs, which is undone where it costs more than
// `tolerance`.
Descent Descend(const VariableProjection& projection,
                const MovingKnots& start,
                const DescentOptions& options,
                ThreadPool& pool);

}  // namespace batten::internal
