// SPDX-License-Identifier: MIT
// Local spline projection: coefficients that depend on the function nearby only.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The projection f ↦ Σ c_i N_i, c = matrix · (f(places), f'(lower), f'(upper)), onto the splines
// over a basis: it reproduces splines over the basis and approximates a smooth function to order
// h^{p+1} in the span width h. Coefficient i is the polar value, at its knots, of the polynomial of
// degree p through f at p + 1 places of the longest span on which N_i acts; so values of f
// elsewhere do not affect it. Value and slope at clamped ends are those of f. [de Boor & Fix 1973;
// Lyche & Schumaker 1975]
struct LocalProjection {
  Eigen::VectorXd places;                               // p + 1 in every span, its ends among them
  std::vector<int> spans;                               // the span each belongs to
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix;  // size of the basis × (places + 2)
};

// The parameter distance of the outermost two coefficients at a clamped end: their difference
// divided by it is the slope there.
double EndLength(const SplineBasis& basis, bool upper);

// Builds the projection onto a basis. O(n·p³).
LocalProjection ProjectionOnto(const SplineBasis& basis);

}  // namespace batten::internal
