// SPDX-License-Identifier: MIT
#include "geometry/bezier/bezier_span.h"

namespace batten::internal {

// De Boor's triangle on the unit vectors, a column each, with another argument at every level.
// [Ramshaw 1989]
Eigen::MatrixXd BezierSpanMatrix(const SplineBasis& basis, int span) {
  const int p = basis.degree();
  const double* U = basis.knots().data();
  Eigen::MatrixXd result(p + 1, p + 1);
  for (int j = 0; j <= p; ++j) {
    Eigen::MatrixXd d = Eigen::MatrixXd::Identity(p + 1, p + 1);
    for (int r = 1; r <= p; ++r) {
      const double x = r <= p - j ? U[span] : U[span + 1];
      for (int k = p; k >= r; --k) {
        const int i = span - p + k;
        const double a = (x - U[i]) / (U[i + p - r + 1] - U[i]);
        d.col(k) = (1 - a) * d.col(k - 1) + a * d.col(k);
      }
    }
    result.row(j) = d.col(p);
  }
  return result;
}

}  // namespace batten::internal
