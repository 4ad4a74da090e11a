// SPDX-License-Identifier: MIT
// Functions as splines, by coefficients that depend on the function nearby only.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The projection f ↦ Σ c_i N_i, c = matrix · (f(places), f'(lower), f'(upper)), onto the splines
// over a basis: splines over it come back as they are, and a smooth function to h^{p+1} of the
// spans. Coefficient i is the polar value, at its knots, of the polynomial of degree p through f at
// p + 1 places of the longest span on which N_i acts; so what f is elsewhere does not touch it. At
// clamped ends value and slope are those of f. [de Boor & Fix 1973; Lyche & Schumaker 1975]
struct LocalProjection {
  Eigen::VectorXd places;                               // p + 1 in every span, its ends among them
  std::vector<int> spans;                               // the span each belongs to
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix;  // size of the basis × (places + 2)
};

// How far apart the outermost two coefficients at a clamped end lie, as parameters: by this their
// difference is the slope there.
double EndLength(const SplineBasis& basis, bool upper);

// O(n·p³).
LocalProjection ProjectionOnto(const SplineBasis& basis);

}  // namespace batten::internal
