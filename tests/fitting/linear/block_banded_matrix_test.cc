// SPDX-License-Identifier: MIT
#include "fitting/linear/block_banded_matrix.h"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::block_banded_matrix_test {

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

// L·D·Lᵀ with a unit lower triangle of which inside a block row the last block is banded like that
// of splines. Block sizes fit no register, steps end anywhere.
BlockBandedMatrix Product(
    RandomSplines& random, int blocks, int block_size, int bandwidth, const Eigen::VectorXd& d) {
  const int n = blocks * block_size;
  const int reach = bandwidth * block_size + random.Integer(0, block_size - 1);
  Eigen::MatrixXd l = Eigen::MatrixXd::Identity(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = std::max({0, i - reach, (i / block_size - bandwidth) * block_size}); j < i; ++j)
      l(i, j) = random.Real(-1, 1) / std::sqrt(1.0 + reach);
  }
  const Eigen::MatrixXd dense = l * d.asDiagonal() * l.transpose();
  BlockBandedMatrix matrix(blocks, block_size, bandwidth);
  for (int row = 0; row < blocks; ++row) {
    for (int below = 0; below <= std::min(row, bandwidth); ++below) {
      matrix.at(row, below) =
          dense.block(row * block_size, (row - below) * block_size, block_size, block_size);
    }
  }
  return matrix;
}

// Calls law(random, blocks, size, bandwidth) for shapes from curves to small nets.
void ForShapes(const std::function<void(RandomSplines&, int, int, int)>& law) {
  for (unsigned seed = 0; seed < 80; ++seed) {
    RandomSplines random(seed);
    const int size = random.Integer(1, 40), bandwidth = random.Integer(0, 5);
    const int blocks = random.Integer(1, std::max(1, 240 / size));
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + std::to_string(blocks) + " blocks of " +
                 std::to_string(size) + ", bandwidth " + std::to_string(bandwidth));
    law(random, blocks, size, bandwidth);
    if (testing::Test::HasFailure()) return;
  }
}

Eigen::VectorXd RandomDiagonal(RandomSplines& random, int n) {
  return Eigen::VectorXd::NullaryExpr(n, [&] { return random.Real(0.5, 2); });
}

TEST(BlockBandedMatrixTest, OfEveryShapeIsFactoredAndSolvedLikeADenseMatrix) {
  ForShapes([](RandomSplines& random, int blocks, int size, int bandwidth) {
    BlockBandedMatrix matrix =
        Product(random, blocks, size, bandwidth, RandomDiagonal(random, blocks * size));
    const Eigen::LLT<Eigen::MatrixXd> dense(Dense(matrix));
    ASSERT_TRUE(matrix.Factor());
    const Eigen::MatrixXd l = dense.matrixL(), own = Dense(matrix).triangularView<Eigen::Lower>();
    EXPECT_LE((own - l).cwiseAbs().maxCoeff(), kIterated * l.cwiseAbs().maxCoeff());
    const Eigen::MatrixXd rhs = RandomMatrix(random, matrix.size(), random.Integer(1, 19)),
                          expected = dense.solve(rhs);
    Eigen::MatrixXd solution = rhs;
    matrix.Solve(solution);
    EXPECT_LE((solution - expected).cwiseAbs().maxCoeff(),
              kIterated * expected.cwiseAbs().maxCoeff());
  });
}

// Backward stable: L·Lᵀ is the matrix up to rounding, however near to singular that is.
TEST(BlockBandedMatrixTest, IsItsFactorsProductWhereItIsNearlySingular) {
  ForShapes([](RandomSplines& random, int blocks, int size, int bandwidth) {
    Eigen::VectorXd d = RandomDiagonal(random, blocks * size);
    const int weak = random.Integer(0, blocks * size - 1);
    d[weak] = 1e-9;
    BlockBandedMatrix matrix = Product(random, blocks, size, bandwidth, d);
    const Eigen::MatrixXd dense = Dense(matrix);
    ASSERT_TRUE(matrix.Factor());
    const Eigen::MatrixXd l = Dense(matrix).triangularView<Eigen::Lower>();
    EXPECT_LE((l * l.transpose() - dense).cwiseAbs().maxCoeff(),
              kRounding * dense.cwiseAbs().maxCoeff());
    EXPECT_NEAR(matrix.SmallestPivot(), 1e-9, 1e-9 * 1e-2);
  });
}

TEST(BlockBandedMatrixTest, OfOneNegativePivotIsRefusedWhereverThatIs) {
  ForShapes([](RandomSplines& random, int blocks, int size, int bandwidth) {
    Eigen::VectorXd d = RandomDiagonal(random, blocks * size);
    d[random.Integer(0, blocks * size - 1)] = -1e-6;
    EXPECT_FALSE(Product(random, blocks, size, bandwidth, d).Factor());
  });
  BlockBandedMatrix undefined(2, 20, 1);
  undefined.AddToDiagonal(1);
  undefined.at(1, 0)(3, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(undefined.Factor());
}

TEST(BlockBandedMatrixTest, HasNoBlocksOutsideOfTheBandsLowerHalf) {
  BlockBandedMatrix matrix(5, 3, 2);
  for (int row = -1; row < 6; ++row) {
    for (int below = -1; below < 4; ++below) {
      SCOPED_TRACE(testing::Message() << "row " << row << ", below " << below);
      if (row >= 0 && row < 5 && below >= 0 && below <= std::min(row, 2)) {
        EXPECT_NO_THROW(matrix.at(row, below).setOnes());
      } else {
        EXPECT_THROW(matrix.at(row, below), std::invalid_argument);
      }
    }
  }
  // Each is there once: the diagonal's five, and four and three below.
  EXPECT_EQ(matrix.Trace(), 15);
  EXPECT_EQ(matrix.Times(Eigen::MatrixXd::Ones(15, 1)).sum(), 9 * (5 + 2 * (4 + 3)));
}

TEST(BlockBandedMatrixTest, IsTheSameBitByBitOnAnyNumberOfThreads) {
  RandomSplines random(7);
  const BlockBandedMatrix matrix = Product(random, 5, 101, 3, RandomDiagonal(random, 5 * 101));
  BlockBandedMatrix alone = matrix;
  ASSERT_TRUE(alone.Factor());
  for (const int threads : {1, 2, 3}) {
    ThreadPool pool(threads);
    BlockBandedMatrix shared = matrix;
    ASSERT_TRUE(shared.Factor(&pool));
    EXPECT_EQ(Dense(shared).triangularView<Eigen::Lower>().toDenseMatrix(),
              Dense(alone).triangularView<Eigen::Lower>().toDenseMatrix());
  }
}

TEST(BlockBandedMatrixTest, SolvesEachColumnAsIfItWereAlone) {
  RandomSplines random(8);
  BlockBandedMatrix matrix = Product(random, 9, 11, 3, RandomDiagonal(random, 99));
  ASSERT_TRUE(matrix.Factor());
  const Eigen::MatrixXd rhs = RandomMatrix(random, 99, 13);
  Eigen::MatrixXd all = rhs;
  matrix.Solve(all);
  for (Eigen::Index k = 0; k < rhs.cols(); ++k) {
    Eigen::MatrixXd one = rhs.col(k);
    matrix.Solve(one);
    EXPECT_EQ(one, all.col(k));
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

}  // namespace batten::internal::block_banded_matrix_test
