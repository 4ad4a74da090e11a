// SPDX-License-Identifier: MIT
#include "geometry/forms/power_basis.h"

namespace batten::internal {
namespace {

// Row n of Pascal's triangle below the diagonal.
Eigen::MatrixXd Binomials(int n) {
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(n + 1, n + 1);
  for (int i = 0; i <= n; ++i) {
    c(i, 0) = 1;
    for (int k = 1; k <= i; ++k) c(i, k) = c(i - 1, k - 1) + (k < i ? c(i - 1, k) : 0);
  }
  return c;
}

}  // namespace

Eigen::MatrixXd PowersOfBernstein(int n) {
  const Eigen::MatrixXd c = Binomials(n);
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(n + 1, n + 1);
  for (int k = 0; k <= n; ++k) {
    for (int i = 0; i <= k; ++i) m(i, k) = ((k - i) % 2 == 0 ? 1 : -1) * c(n, k) * c(k, i);
  }
  return m;
}

Eigen::MatrixXd BernsteinOfPowers(int n) {
  const Eigen::MatrixXd c = Binomials(n);
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(n + 1, n + 1);
  for (int j = 0; j <= n; ++j) {
    for (int k = 0; k <= j; ++k) m(k, j) = c(j, k) / c(n, k);
  }
  return m;
}

}  // namespace batten::internal
