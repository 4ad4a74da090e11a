// SPDX-License-Identifier: MIT
#include "geometry/numeric/dense_solvers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::dense_solvers_test {

Eigen::MatrixXd Random(RandomSplines& random, Eigen::Index rows, Eigen::Index columns) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.Real(-1, 1); });
}

// Of any rank up to its lesser side, the singular values apart from zero.
Eigen::MatrixXd RandomOfRank(RandomSplines& random, int rows, int columns, int rank) {
  const auto basis = [&](int size) {
    Eigen::MatrixXd q = Random(random, size, rank);
    for (int k = 0; k < rank; ++k) {  // twice: once leaves rounding over the sine of an angle
      for (int again = 0; again < 2; ++again)
        q.col(k) -= q.leftCols(k) * (q.leftCols(k).transpose() * q.col(k)).eval();
      q.col(k).normalize();
    }
    return q;
  };
  const Eigen::VectorXd sizes =
      Eigen::VectorXd::NullaryExpr(rank, [&] { return random.Real(0.5, 2); });
  const Eigen::MatrixXd left = basis(rows), right = basis(columns);
  return left * sizes.asDiagonal() * right.transpose();
}

double Greatest(const Eigen::MatrixXd& a) { return a.size() > 0 ? a.cwiseAbs().maxCoeff() : 0; }

template <typename Law>
void ForMatrices(const Law& law) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int rows = random.Integer(1, 9), columns = random.Integer(1, 6),
              rank = random.Integer(1, std::min(rows, columns));
    law(random, RandomOfRank(random, rows, columns, rank), rank);
  }
}

TEST(LeastSquaresTest, LeavesResidualsAcrossTheColumns) {
  ForMatrices([](RandomSplines& random, const Eigen::MatrixXd& a, int rank) {
    if (rank < a.cols()) return;  // the columns depend on each other
    const Eigen::MatrixXd b = Random(random, a.rows(), 3), x = LeastSquares(a, b);
    ASSERT_EQ(x.rows(), a.cols());
    EXPECT_LE(Greatest(a.transpose() * (a * x - b)), kRounding);
  });
}

TEST(LeastNormSolutionTest, IsTheSmallestOfLeastResidual) {
  ForMatrices([](RandomSplines& random, const Eigen::MatrixXd& a, int rank) {
    const Eigen::MatrixXd b = Random(random, a.rows(), 2), x = LeastNormSolution(a, b, kHalfDigits);
    EXPECT_LE(Greatest(a.transpose() * (a * x - b)), kRounding);
    // The smallest has no part that the matrix maps to nothing.
    const Eigen::MatrixXd nothing = SingularValuesOf(a).v.rightCols(a.cols() - rank);
    EXPECT_LE(Greatest(nothing.transpose() * x), kRounding);
  });
}

TEST(LeastNormSolutionTest, TakesWhatIsBelowTheThresholdForNothing) {
  const Eigen::Matrix2d a{{1, 0}, {0, 1e-3}};
  const Eigen::Vector2d b(1, 1);
  EXPECT_LE(Greatest(LeastNormSolution(a, b, 1e-4) - Eigen::Vector2d(1, 1e3)), 1e3 * kRounding);
  EXPECT_LE(Greatest(LeastNormSolution(a, b, 1e-2) - Eigen::Vector2d(1, 0)), kRounding);
}

TEST(EigenOfTest, TurnsTheMatrixIntoItsValues) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int n = random.Integer(1, 9);
    const Eigen::MatrixXd any = Random(random, n, n), a = any + any.transpose();
    const auto [values, vectors] = EigenOf(a);
    EXPECT_TRUE(std::is_sorted(values.begin(), values.end()));
    EXPECT_LE(Greatest(vectors.transpose() * vectors - Eigen::MatrixXd::Identity(n, n)), kRounding);
    EXPECT_LE(Greatest(vectors * values.asDiagonal() * vectors.transpose() - a), 10 * kRounding);
  }
}

// Also of fewer rows than columns: the last of V are what the matrix maps to nothing.
TEST(SingularValuesOfTest, AreTheSizesOfWhatItsVectorsAreMappedTo) {
  ForMatrices([](RandomSplines&, const Eigen::MatrixXd& a, int rank) {
    const Eigen::Index n = a.cols();
    const auto [values, v] = SingularValuesOf(a);
    ASSERT_EQ(values.size(), n);
    EXPECT_TRUE(std::is_sorted(values.begin(), values.end(), std::greater<>()));
    EXPECT_LE(Greatest(v.transpose() * v - Eigen::MatrixXd::Identity(n, n)), kRounding);
    const Eigen::MatrixXd squares = values.cwiseAbs2().asDiagonal();
    EXPECT_LE(Greatest((a * v).transpose() * (a * v) - squares), 10 * kRounding);
    EXPECT_GE(values[rank - 1], 0.4);
    EXPECT_LE(Greatest(values.tail(n - rank)), kRounding);
  });
}

}  // namespace batten::internal::dense_solvers_test
