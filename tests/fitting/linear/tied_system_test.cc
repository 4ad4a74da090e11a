// SPDX-License-Identifier: MIT
#include "fitting/linear/tied_system.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <numbers>
#include <random>

#include "fitting/linear/coefficient_order.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/least_squares/pole_rows.h"
#include "batten/fitting/poles.h"
#include "batten/geometry/knot_vectors.h"

namespace batten::internal::tied_system_test {

Eigen::MatrixXd Random(Eigen::Index rows, Eigen::Index columns, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(
      rows, columns, [&](Eigen::Index, Eigen::Index) { return normal(random); });
}

// Of diagonal blocks that weigh more than all beside them.
BlockBandedMatrix RandomBand(int blocks, int size, int bandwidth, std::mt19937_64& random) {
  BlockBandedMatrix matrix(blocks, size, bandwidth);
  for (int row = 0; row < blocks; ++row) {
    for (int below = 0; below <= std::min(bandwidth, row); ++below) {
      const Eigen::MatrixXd part = Random(size, size, random);
      if (below > 0) {
        matrix.at(row, below) = part;
      } else {
        matrix.at(row, below) = part + part.transpose();
      }
    }
  }
  matrix.AddToDiagonal(8.0 * size * (bandwidth + 1));
  return matrix;
}

Eigen::MatrixXd Dense(const BlockBandedMatrix& matrix) {
  return matrix.Times(Eigen::MatrixXd::Identity(matrix.size(), matrix.size()));
}

// Rows of a range of blocks, and of a range inside them, are free; the rest tied to some unknowns.
NetTies RandomTies(int blocks, int size, std::mt19937_64& random) {
  NetTies ties;
  const auto range = [&](int count, int& first, int& length) {
    first = static_cast<int>(random() % static_cast<unsigned>(count));
    length = static_cast<int>(random() % static_cast<unsigned>(count - first + 1));
  };
  range(blocks, ties.first_block, ties.blocks);
  range(size, ties.first_row, ties.rows);
  for (int row = 0; row < blocks * size; ++row) {
    const int block = row / size - ties.first_block, inside = row % size - ties.first_row;
    if (block < 0 || block >= ties.blocks || inside < 0 || inside >= ties.rows)
      ties.tied.push_back(row);
  }
  std::shuffle(ties.tied.begin(), ties.tied.end(), random);
  const Eigen::Index tied = std::ssize(ties.tied);
  if (tied == 0) return ties;
  const auto unknowns = 1 + static_cast<Eigen::Index>(random() % 17) % tied;
  ties.forms = Eigen::HouseholderQR<Eigen::MatrixXd>(Random(tied, tied, random)).householderQ() *
               Eigen::MatrixXd::Identity(tied, unknowns);
  return ties;
}

// All of Z: the free rows, then the unknowns of the tied ones.
Eigen::MatrixXd AllForms(const NetTies& ties, int blocks, int size) {
  const Eigen::Index free = Eigen::Index{blocks} * size - std::ssize(ties.tied);
  Eigen::MatrixXd z = Eigen::MatrixXd::Zero(Eigen::Index{blocks} * size, free + ties.forms.cols());
  Eigen::Index to = 0;
  for (Eigen::Index row = 0; row < z.rows(); ++row) {
    if (std::find(ties.tied.begin(), ties.tied.end(), row) == ties.tied.end()) z(row, to++) = 1;
  }
  for (size_t k = 0; k < ties.tied.size(); ++k)
    z.row(ties.tied[k]).tail(ties.forms.cols()) = ties.forms.row(static_cast<Eigen::Index>(k));
  return z;
}

TEST(TiedSystemTest, SolvesAsTheDenseReducedMatrixDoes) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    const int blocks = 1 + static_cast<int>(random() % 12),
              size = 1 + static_cast<int>(random() % 9);
    const BlockBandedMatrix matrix =
        RandomBand(blocks, size, static_cast<int>(random() % 4), random);
    const NetTies ties = RandomTies(blocks, size, random);
    const Eigen::MatrixXd z = AllForms(ties, blocks, size),
                          rhs = Random(matrix.size(), 1 + trial % 20, random);
    TiedSystem system(matrix, ties);
    ASSERT_TRUE(system.Factor());
    Eigen::MatrixXd solved = rhs;
    system.Solve(solved);
    const Eigen::MatrixXd reduced = z.transpose() * Dense(matrix) * z;
    const Eigen::MatrixXd expected = z * reduced.partialPivLu().solve(z.transpose() * rhs);
    // Condition numbers of a few units.
    EXPECT_LT((solved - expected).norm(), 1e-13 * rhs.norm());
    EXPECT_GT(system.SmallestPivot(), 0);
  }
}

TEST(TiedSystemTest, IndefiniteMatricesAreTold) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    BlockBandedMatrix matrix = RandomBand(6, 5, 2, random);
    const NetTies ties = RandomTies(6, 5, random);
    matrix.AddToDiagonal(-2000);
    TiedSystem system(matrix, ties);
    EXPECT_FALSE(system.Factor());
  }
}

TEST(TiedSystemTest, ThreadsChangeNoBit) {
  std::mt19937_64 random(3);
  ThreadPool pool(3);
  const BlockBandedMatrix matrix = RandomBand(8, 90, 3, random);
  NetTies ties{0, 8, 2, 86, {}, {}};
  for (int row = 0; row < matrix.size(); ++row) {
    if (row % 90 < 2 || row % 90 >= 88) ties.tied.push_back(row);
  }
  ties.forms = Eigen::MatrixXd::Identity(std::ssize(ties.tied), 9);
  TiedSystem one(matrix, ties), many(matrix, ties);
  ASSERT_TRUE(one.Factor());
  ASSERT_TRUE(many.Factor(&pool));
  const Eigen::MatrixXd rhs = Random(matrix.size(), 3, random);
  Eigen::MatrixXd a = rhs, b = rhs;
  one.Solve(a);
  many.Solve(b);
  EXPECT_EQ(a, b);
}

// Elimination and Lagrange's multipliers: x − M⁻¹Cᵀ (C M⁻¹ Cᵀ)⁻¹ C x with x = M⁻¹b.
TEST(TiedSystemTest, MeetsTheConditionsOfPolesAsMultipliersDo) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 80; ++trial) {
    SCOPED_TRACE(trial);
    const int p = 1 + static_cast<int>(random() % 4), q = 1 + static_cast<int>(random() % 4);
    const int cells = p + 1 + static_cast<int>(random() % 8);
    const SplineBasis u =
        trial % 2 == 0 ? PeriodicUniformKnots(p, cells, 0, 7) : FittingBasis(p, cells, 0, 7);
    const SplineBasis v = FittingBasis(q, 2 + static_cast<int>(random() % 14), 0, 3);
    const auto kind = [&] { return static_cast<PoleKind>(random() % 3); };
    const Poles poles{kind(), kind(), trial % 2 == 0 ? 2 * std::numbers::pi : 1.5};
    const bool u_outside = random() % 2 == 0;
    const SplineBasis &outer = u_outside ? u : v, &inner = u_outside ? v : u;
    const CoefficientOrder order(outer);
    const BlockBandedMatrix matrix =
        RandomBand(order.count(), DistinctCount(inner), order.bandwidth(), random);
    const Eigen::MatrixXd on_net = PoleConditions(u, v, poles);
    Eigen::MatrixXd conditions(on_net.rows(), on_net.cols());
    const std::vector<int> rows = order.Rows(outer);
    for (Eigen::Index i = 0; i < DistinctCount(u); ++i) {
      for (Eigen::Index j = 0; j < v.size(); ++j) {
        const Eigen::Index at_outer = rows[static_cast<size_t>(u_outside ? i : j)];
        conditions.col(at_outer * DistinctCount(inner) + (u_outside ? j : i)) =
            on_net.col(i * v.size() + j);
      }
    }
    const NetTies ties = PoleTies(u, v, poles, u_outside);
    EXPECT_EQ(std::ssize(ties.tied) - ties.forms.cols(), conditions.rows());
    TiedSystem system(matrix, ties);
    ASSERT_TRUE(system.Factor());
    const Eigen::MatrixXd rhs = Random(matrix.size(), 3, random);
    Eigen::MatrixXd solved = rhs;
    system.Solve(solved);
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(Dense(matrix));
    Eigen::MatrixXd expected = lu.solve(rhs);
    if (conditions.rows() > 0) {
      const Eigen::MatrixXd pushes = lu.solve(conditions.transpose());
      expected -= pushes * (conditions * pushes).fullPivLu().solve(conditions * expected);
    }
    // The middle's form makes conditions a thousand times longer over part of a turn.
    EXPECT_LT((solved - expected).norm(), 1e-11 * rhs.norm());
    EXPECT_LT((conditions * solved).norm(), 1e-11 * rhs.norm());
  }
}

}  // namespace batten::internal::tied_system_test
