// SPDX-License-Identifier: MIT
#include "geometry/bezier/bernstein.h"

#include <algorithm>

#include "geometry/nurbs/rational_derivatives.h"

namespace batten::internal {

void BernsteinValues(int n, double t, double* B) {
  B[0] = 1;
  for (int m = 1; m <= n; ++m) {
    double saved = 0;
    for (int i = 0; i < m; ++i) {
      const double old = B[i];
      B[i] = saved + (1 - t) * old;
      saved = t * old;
    }
    B[m] = saved;
  }
}

// From the polynomials of degree n−k, k differences lead up to degree n: B'_{i,m} = m (B_{i−1,m−1}
// − B_{i,m−1}). [eq. 1.9]
void BernsteinDerivatives(int n, double t, int order, double* values) {
  for (int k = 0; k <= order; ++k) {
    double* row = values + k * (n + 1);
    std::fill_n(row, n + 1, 0.0);
    if (k > n) continue;
    BernsteinValues(n - k, t, row);
    for (int m = n - k + 1; m <= n; ++m) {
      for (int i = m; i >= 0; --i) row[i] = m * ((i > 0 ? row[i - 1] : 0) - (i < m ? row[i] : 0));
    }
  }
}

Eigen::VectorXd DeCasteljau(Eigen::MatrixXd P, double t) {
  for (Eigen::Index last = P.cols() - 1; last > 0; --last) {
    for (Eigen::Index i = 0; i < last; ++i) P.col(i) = (1 - t) * P.col(i) + t * P.col(i + 1);
  }
  return P.col(0);
}

Eigen::MatrixXd ElevatedBernstein(const Eigen::MatrixXd& P, int by) {
  if (by == 0) return P;
  return BernsteinProduct(P, Eigen::RowVectorXd::Ones(by + 1));
}

Eigen::MatrixXd BernsteinProduct(const Eigen::MatrixXd& f, const Eigen::RowVectorXd& g) {
  const int m = static_cast<int>(f.cols()) - 1, n = static_cast<int>(g.size()) - 1;
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(f.rows(), m + n + 1);
  for (int k = 0; k <= m + n; ++k) {
    for (int i = std::max(0, k - n); i <= std::min(k, m); ++i) {
      h.col(k) += Binomial(m, i) * Binomial(n, k - i) / Binomial(m + n, k) * g[k - i] * f.col(i);
    }
  }
  return h;
}

Eigen::MatrixXd BernsteinDerivative(const Eigen::MatrixXd& P) {
  const Eigen::Index n = P.cols() - 1;
  if (n == 0) return Eigen::MatrixXd::Zero(P.rows(), 1);
  return double(n) * (P.rightCols(n) - P.leftCols(n));
}

std::pair<Eigen::MatrixXd, Eigen::MatrixXd> SplitBernstein(Eigen::MatrixXd right, double t) {
  const Eigen::Index n = right.cols() - 1;
  Eigen::MatrixXd left(right.rows(), n + 1);
  for (Eigen::Index i = 0; i <= n; ++i) {
    left.col(i) = right.col(0);
    for (Eigen::Index k = 0; k < n - i; ++k) {
      right.col(k) = (1 - t) * right.col(k) + t * right.col(k + 1);
    }
  }
  return {std::move(left), std::move(right)};
}

Eigen::MatrixXd RestrictedBernstein(Eigen::MatrixXd P, double s, double t) {
  if (t < 1) P = SplitBernstein(std::move(P), t).first;
  if (s > 0) P = SplitBernstein(std::move(P), s / t).second;
  return P;
}

}  // namespace batten::internal
