// SPDX-License-Identifier: MIT
// From derivatives of the homogeneous form (w·C, w) to those of the curve or surface itself.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

// In place: columns k = 0 … of `homogeneous` are (w·C)^(k), last row w^(k); on return the leading
// rows hold C^(k). Needs w ≠ 0. [Piegl & Tiller 1997, A4.2]
void RationalCurveDerivatives(Eigen::MatrixXd& homogeneous);

// The same for a surface: column k·(order+1)+l is ∂^(k+l)/∂u^k∂v^l of (w·S, w), for k+l ≤ order.
// [A4.4]
void RationalSurfaceDerivatives(int order, Eigen::Matrix4Xd& homogeneous);

// Binomial coefficients up to 2·kMaxDegree, exact in double.
double Binomial(int n, int k);

}  // namespace batten::internal
