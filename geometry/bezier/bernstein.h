// SPDX-License-Identifier: MIT
// Bernstein polynomials, and vector-valued polynomials in Bernstein form on [0, 1].
#pragma once

#include <Eigen/Core>
#include <utility>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// values[i] = B_{i,n}(t) = C(n,i) t^i (1−t)^(n−i) for i = 0 … n; n ≥ 0, any t. For t in [0, 1] each
// is right to 2n·ε of itself. O(n²). [Piegl & Tiller 1997, A1.2]
void BernsteinValues(int n, double t, double* values);

// values[k·(n+1)+i] = d^k B_{i,n} / dt^k for k = 0 … order; zero for k > n. [eq. 1.9]
void BernsteinDerivatives(int n, double t, int order, double* values);

// Below, columns 0 … n of a matrix are the Bernstein coefficients of a polynomial of degree n.

// The value at t by de Casteljau's corner cutting. [A1.5]
Eigen::VectorXd DeCasteljau(Eigen::MatrixXd coefficients, double t);

// The same polynomial with degree n + by: C(n+by,i) Q_i = Σ_j C(n,j) C(by,i−j) P_j. [eq. 5.36]
Eigen::MatrixXd ElevatedBernstein(const Eigen::MatrixXd& coefficients, int by);

// f·g of degree m + n: C(m+n,k) h_k = Σ_i C(m,i) C(n,k−i) f_i g_{k−i}. [Farouki & Rajan 1988]
Eigen::MatrixXd BernsteinProduct(const Eigen::MatrixXd& f, const Eigen::RowVectorXd& g);

// The derivative, of degree n − 1; of degree 0 for a constant.
Eigen::MatrixXd BernsteinDerivative(const Eigen::MatrixXd& coefficients);

// The parts on [0, t] and [t, 1], each brought to [0, 1].
std::pair<Eigen::MatrixXd, Eigen::MatrixXd> SplitBernstein(Eigen::MatrixXd coefficients, double t);

// The part on [s, t], 0 ≤ s < t ≤ 1, brought to [0, 1].
Eigen::MatrixXd RestrictedBernstein(Eigen::MatrixXd coefficients, double s, double t);

}  // namespace batten::internal
