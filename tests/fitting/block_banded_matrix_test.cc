// SPDX-License-Identifier: MIT
#include "batten/fitting/block_banded_matrix.h"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <functional>
#include <stdexcept>
#include <string>

#include "random_splines.h"
#include "tolerances.h"

namespace batten {
namespace {

Eigen::MatrixXd RandomMatrix(RandomSplines& random, int rows, int columns) {
  Eigen::MatrixXd matrix(rows, columns);
  for (double& x : matrix.reshaped()) x = random.Real(-1, 1);
  return matrix;
}

// Both triangles of what the lower half says.
Eigen::MatrixXd Dense(const BlockBandedMatrix& matrix) {
  const int b = matrix.block_size();
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(matrix.size(), matrix.size());
  for (int row = 0; row < matrix.blocks(); ++row) {
    for (int below = 0; below <= std::min(row, matrix.bandwidth()); ++below) {
      dense.block((row - below) * b, row * b, b, b) = matrix.at(row, below).transpose();
      dense.block(row * b, (row - below) * b, b, b) = matrix.at(row, below);
    }
  }
  return dense;
}

// Symmetric and positive definite because its diagonal dominates.
BlockBandedMatrix RandomPositive(RandomSplines& random, int blocks, int block_size, int bandwidth) {
  BlockBandedMatrix matrix(blocks, block_size, bandwidth);
  for (int row = 0; row < blocks; ++row) {
    for (int below = 0; below <= std::min(row, bandwidth); ++below) {
      matrix.at(row, below) = RandomMatrix(random, block_size, block_size);
    }
    const Eigen::MatrixXd diagonal = matrix.at(row, 0);
    matrix.at(row, 0) = diagonal + diagonal.transpose();
  }
  matrix.AddToDiagonal(1.01 * Dense(matrix).cwiseAbs().rowwise().sum().maxCoeff());
  return matrix;
}

// Calls law(matrix, random) for positive definite matrices of many shapes.
void ForRandomMatrices(const std::function<void(BlockBandedMatrix, RandomSplines&)>& law) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomSplines random(seed);
    const int blocks = random.Integer(1, 14), size = random.Integer(1, 9);
    const int bandwidth = random.Integer(0, 16);  // wider than the matrix, too
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + std::to_string(blocks) + " blocks of " +
                 std::to_string(size) + ", bandwidth " + std::to_string(bandwidth));
    law(RandomPositive(random, blocks, size, bandwidth), random);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(BlockBandedMatrixTest, IsSolvedLikeADenseMatrix) {
  ForRandomMatrices([](BlockBandedMatrix matrix, RandomSplines& random) {
    const Eigen::MatrixXd dense = Dense(matrix);
    const Eigen::MatrixXd rhs = RandomMatrix(random, matrix.size(), random.Integer(1, 4));
    const Eigen::MatrixXd expected = dense.llt().solve(rhs);
    ASSERT_TRUE(matrix.Factor());
    Eigen::MatrixXd solution = rhs;
    matrix.Solve(solution);
    EXPECT_LE((solution - expected).cwiseAbs().maxCoeff(),
              kRounding * expected.cwiseAbs().maxCoeff());
  });
}

TEST(BlockBandedMatrixTest, BecomesItsLowerCholeskyFactor) {
  ForRandomMatrices([](BlockBandedMatrix matrix, RandomSplines&) {
    const Eigen::MatrixXd dense = Dense(matrix);
    ASSERT_TRUE(matrix.Factor());
    const Eigen::MatrixXd factor = Dense(matrix).triangularView<Eigen::Lower>();
    EXPECT_LE((factor * factor.transpose() - dense).cwiseAbs().maxCoeff(),
              kRounding * dense.cwiseAbs().maxCoeff());
  });
}

TEST(BlockBandedMatrixTest, ReadsOnlyTheLowerTriangleOfDiagonalBlocks) {
  RandomSplines random(1);
  BlockBandedMatrix whole = RandomPositive(random, 5, 4, 2), half = whole;
  for (int row = 0; row < half.blocks(); ++row) {
    half.at(row, 0).triangularView<Eigen::StrictlyUpper>().setConstant(1e300);
  }
  Eigen::MatrixXd expected = RandomMatrix(random, whole.size(), 2), solution = expected;
  ASSERT_TRUE(whole.Factor());
  ASSERT_TRUE(half.Factor());
  whole.Solve(expected);
  half.Solve(solution);
  EXPECT_EQ(solution, expected);
}

TEST(BlockBandedMatrixTest, RefusesToFactorWhatIsNotPositiveDefinite) {
  ForRandomMatrices([](BlockBandedMatrix matrix, RandomSplines& random) {
    const int row = random.Integer(0, matrix.blocks() - 1);
    const int i = random.Integer(0, matrix.block_size() - 1);
    BlockBandedMatrix negative = matrix;
    negative.at(row, 0)(i, i) *= -1;
    EXPECT_FALSE(negative.Factor());
  });
  BlockBandedMatrix zero(3, 2, 1);
  EXPECT_FALSE(zero.Factor());
  // [1 2; 2 1] over two blocks: its diagonal is positive, its determinant is not.
  BlockBandedMatrix indefinite(2, 1, 1);
  indefinite.at(0, 0)(0, 0) = indefinite.at(1, 0)(0, 0) = 1;
  indefinite.at(1, 1)(0, 0) = 2;
  EXPECT_FALSE(indefinite.Factor());
}

TEST(BlockBandedMatrixTest, TellsItsSmallestPivot) {
  ForRandomMatrices([](BlockBandedMatrix matrix, RandomSplines&) {
    const Eigen::MatrixXd factor = Dense(matrix).llt().matrixL();
    ASSERT_TRUE(matrix.Factor());
    const double expected = factor.diagonal().cwiseAbs2().minCoeff();
    EXPECT_NEAR(matrix.SmallestPivot(), expected, kRounding * expected);
  });
}

TEST(BlockBandedMatrixTest, HasTheTraceOfTheDenseMatrix) {
  ForRandomMatrices([](const BlockBandedMatrix& matrix, RandomSplines&) {
    const double expected = Dense(matrix).trace();
    EXPECT_NEAR(matrix.Trace(), expected, kRounding * expected);
  });
}

TEST(BlockBandedMatrixTest, TakesAMultipleOfTheIdentityOnItsDiagonal) {
  ForRandomMatrices([](BlockBandedMatrix matrix, RandomSplines&) {
    const Eigen::MatrixXd before = Dense(matrix);
    matrix.AddToDiagonal(0.75);
    Eigen::MatrixXd expected = before;
    expected.diagonal().array() += 0.75;
    EXPECT_EQ(Dense(matrix), expected);
  });
}

TEST(BlockBandedMatrixTest, StartsAtZero) {
  const BlockBandedMatrix matrix(4, 3, 2);
  EXPECT_EQ(matrix.size(), 12);
  EXPECT_TRUE(Dense(matrix).isZero(0));
}

TEST(BlockBandedMatrixTest, RefusesSizesThatMakeNoMatrix) {
  EXPECT_THROW(BlockBandedMatrix(0, 1, 1), std::invalid_argument);
  EXPECT_THROW(BlockBandedMatrix(1, 0, 1), std::invalid_argument);
  EXPECT_THROW(BlockBandedMatrix(1, 1, -1), std::invalid_argument);
}

}  // namespace
}  // namespace batten
