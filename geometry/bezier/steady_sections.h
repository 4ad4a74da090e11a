// SPDX-License-Identifier: MIT
// Where to sample a spline so that what holds at the samples holds between them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

struct Section {
  double lower, upper;
};

// The spans of the domain, halved until each row of weights, as the coefficients of a spline over
// the basis, varies by at most a factor of four on every section. (Row: 1 × n.) A polynomial form
// divided by powers of the weight function is then bounded by its samples.
std::vector<Section> SteadySections(const SplineBasis& basis, const Eigen::MatrixXd& weights);

// The `count` ≥ 2 Chebyshev points of the second kind of a section, its ends included: a polynomial
// of degree count − 1 is at most (2/π) ln(count) + 1 times its largest sample.
std::vector<double> WithEnds(const Section& section, int count);

// The `count` Chebyshev points of the first kind, all inside.
std::vector<double> Inside(const Section& section, int count);

}  // namespace batten::internal
