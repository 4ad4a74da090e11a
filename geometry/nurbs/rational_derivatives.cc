// SPDX-License-Identifier: MIT
#include "geometry/nurbs/rational_derivatives.h"

#include <algorithm>

namespace batten::internal {

double Binomial(int n, int k) {
  double value = 1;
  k = std::min(k, n - k);
  for (int i = 1; i <= k; ++i) value = value * (n - k + i) / i;
  return value;
}

// Leibniz' rule for w·C, solved for C^(k). [Piegl & Tiller 1997, A4.2]
void RationalCurveDerivatives(Eigen::MatrixXd& A) {
  const int d = static_cast<int>(A.rows()) - 1;
  const double w = A(d, 0);
  for (int k = 0; k < A.cols(); ++k) {
    Eigen::VectorXd v = A.col(k).head(d);
    for (int i = 1; i <= k; ++i) v -= Binomial(k, i) * A(d, i) * A.col(k - i).head(d);
    A.col(k).head(d) = v / w;
  }
}

// Leibniz' rule in both directions, solved for S^(k,l). [A4.4]
void RationalSurfaceDerivatives(int order, Eigen::Matrix4Xd& A) {
  const int stride = order + 1;
  const double w = A(3, 0);
  for (int k = 0; k <= order; ++k) {
    for (int l = 0; l + k <= order; ++l) {
      Eigen::Vector3d v = A.col(k * stride + l).head<3>();
      for (int i = 0; i <= k; ++i) {
        for (int j = (i == 0 ? 1 : 0); j <= l; ++j) {
          v -= Binomial(k, i) * Binomial(l, j) * A(3, i * stride + j) *
               A.col((k - i) * stride + l - j).head<3>();
        }
      }
      A.col(k * stride + l).head<3>() = v / w;
    }
  }
}

}  // namespace batten::internal
