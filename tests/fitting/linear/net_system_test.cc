// SPDX-License-Identifier: MIT
#include "fitting/linear/net_system.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <string>

#include "batten/geometry/knot_vectors.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::net_system_test {

// The same system as a dense one over the different control points.
TEST(NetSystemTest, SolvesWhatADenseSystemSolves) {
  RandomSplines random(1);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE("seed 1, trial " + std::to_string(trial));
    const int degree = random.Integer(1, 5), d = random.Integer(2, 3);
    const bool periodic = random.Coin();
    const SplineBasis basis =
        periodic ? PeriodicUniformKnots(degree, random.Integer(1, 20), 0, 1)
                 : SplineBasis::Uniform(degree, degree + random.Integer(1, 20), 0, 1);
    const int n = basis.size(), different = periodic ? n - degree : n;
    NetSystem system(basis, d);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(different * d, different * d);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(different * d);
    for (int k = 0; k < 4 * n; ++k) {
      const double u = random.Real(0, 1);
      const int span = basis.Span(u);
      std::vector<double> values(degree + 1);
      basis.Values(span, u, values.data());
      Eigen::MatrixXd metric(d, d);
      Eigen::VectorXd pull(d);
      for (double& x : metric.reshaped()) x = random.Real(-1, 1);
      for (double& x : pull) x = random.Real(-1, 1);
      metric = metric * metric.transpose() + Eigen::MatrixXd::Identity(d, d);
      for (int r = 0; r <= degree; ++r) {
        const int i = span - degree + r, a = i % different;
        system.AddRight(i, values[r] * pull);
        right.segment(a * d, d) += values[r] * pull;
        for (int s = 0; s <= degree; ++s) {
          const int j = span - degree + s, b = j % different;
          if (s <= r) system.Add(i, j, values[r] * values[s] * metric);
          dense.block(a * d, b * d, d, d) += values[r] * values[s] * metric;
        }
      }
    }
    for (int a = 0; a < different; ++a) {  // every control point is held a little
      const Eigen::MatrixXd held = 0.1 * Eigen::MatrixXd::Identity(d, d);
      system.Add(a, a, held);
      dense.block(a * d, a * d, d, d) += held;
    }
    const Eigen::VectorXd expected = dense.ldlt().solve(right);
    const NetSystem::Step step = system.Solve();
    ASSERT_EQ(step.net.cols(), n);
    for (int i = 0; i < n; ++i) {
      EXPECT_LT((step.net.col(i) - expected.segment(i % different * d, d)).norm(),
                kIterated * (1 + expected.norm()));
    }
    EXPECT_NEAR(step.promise, expected.dot(right), kIterated * (1 + std::abs(step.promise)));
  }
}

TEST(NetSystemTest, BearsControlPointsThatNothingHolds) {
  const SplineBasis basis = SplineBasis::Uniform(3, 10, 0, 1);
  NetSystem system(basis, 2);
  system.Add(2, 2, Eigen::Matrix2d::Identity());
  system.AddRight(2, Eigen::Vector2d(3, 4));
  const NetSystem::Step step = system.Solve();
  EXPECT_LT((step.net.col(2) - Eigen::Vector2d(3, 4)).norm(), kRounding);
  EXPECT_EQ(step.net.col(7).norm(), 0);
  EXPECT_EQ(NetSystem(basis, 3).Solve().net.norm(), 0);
}

}  // namespace batten::internal::net_system_test
