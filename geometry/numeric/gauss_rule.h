// SPDX-License-Identifier: MIT
// Gauss–Legendre quadrature.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// ∫ f over [0, 1] = Σ weights[k] f(nodes[k]), exact for polynomials of degree 2·count − 1.
struct GaussRule {
  Eigen::VectorXd nodes, weights;
};

// The rule of `count` ≥ 1 nodes in increasing order, right to the last digit or two. O(count²).
// [Davis & Rabinowitz 1984, §2.7]
GaussRule GaussLegendre(int count);

}  // namespace batten::internal
