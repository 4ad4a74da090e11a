// SPDX-License-Identifier: MIT
#include "fitting/primitives/linear_chebyshev.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "tolerances.h"

namespace batten::internal {
namespace {

// The least greatest residual by looking at every reference of n + 1 points: the optimum is the
// greatest of their optima. [de la Vallée-Poussin 1911]
double ByAllReferences(const Eigen::MatrixXd& j, const Eigen::VectorXd& r) {
  const Eigen::Index n = j.cols(), m = j.rows();
  double most = 0;
  std::vector<Eigen::Index> set(static_cast<size_t>(n + 1));
  std::function<void(size_t, Eigen::Index)> choose = [&](size_t k, Eigen::Index from) {
    if (k == set.size()) {
      const Eigen::MatrixXd null =
          Eigen::MatrixXd(j(set, Eigen::all).transpose()).fullPivLu().kernel();
      if (null.cols() != 1) return;
      most = std::max(most, std::abs(null.col(0).dot(r(set))) / null.col(0).cwiseAbs().sum());
      return;
    }
    for (Eigen::Index i = from; i < m; ++i) {
      set[k] = i;
      choose(k + 1, i + 1);
    }
  };
  choose(0, 0);
  return most;
}

TEST(LinearChebyshevTest, EqualsBruteForce) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (const int n : {1, 2, 3}) {
    for (int run = 0; run < 20; ++run) {
      const int m = n + 2 + run % 8;
      const Eigen::MatrixXd j = Eigen::MatrixXd::NullaryExpr(m, n, [&] { return normal(random); });
      const Eigen::VectorXd r = Eigen::VectorXd::NullaryExpr(m, [&] { return normal(random); });
      const ChebyshevSolution solution = SolveChebyshev(j, r);
      EXPECT_TRUE(solution.solved);
      EXPECT_NEAR(solution.greatest, ByAllReferences(j, r), kIterated);
      EXPECT_NEAR((r + j * solution.x).cwiseAbs().maxCoeff(), solution.greatest, kRounding);
    }
  }
}

TEST(LinearChebyshevTest, EndsWhereManyPointsAreEquallyFar) {
  // A grid of heights ±1 by turns over a plane: ties everywhere.
  Eigen::MatrixXd j(100, 3);
  Eigen::VectorXd r(100);
  for (int k = 0; k < 100; ++k) {
    j.row(k) << k / 10, k % 10, 1;
    r[k] = (k / 10 + k % 10) % 2 ? 1 : -1;
  }
  const ChebyshevSolution solution = SolveChebyshev(j, r);
  EXPECT_NEAR(solution.greatest, 1, kRounding);
}

}  // namespace
}  // namespace batten::internal
