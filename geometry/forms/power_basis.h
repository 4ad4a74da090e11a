// SPDX-License-Identifier: MIT
// The change between Bernstein polynomials and powers.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// a = b · PowersOfBernstein(n) takes Bernstein coefficients (columns 0 … n) to those of 1, t, …,
// t^n, column k being C(n,k) Δ^k b_0; BernsteinOfPowers(n) is its inverse, b_j = Σ_k C(j,k)/C(n,k)
// a_k. [Piegl & Tiller 1997, §6.6]
Eigen::MatrixXd PowersOfBernstein(int n);
Eigen::MatrixXd BernsteinOfPowers(int n);

}  // namespace batten::internal
