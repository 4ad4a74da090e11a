// SPDX-License-Identifier: MIT
#include "fitting/linear/tensor_band.h"

#include <gtest/gtest.h>

#include <random>

#include "tolerances.h"

namespace batten::internal::tensor_band_test {

// Of random factors, and the dense matrix of the same.
struct Pair {
  TensorBand band;
  Eigen::MatrixXd dense;
};
Pair RandomPair(int n, int m, int p, int q, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Pair pair{TensorBand(n, m, p, q), Eigen::MatrixXd::Zero(n * m, n * m)};
  for (int i = 0; i < n; ++i) {
    for (int a = 0; a <= p && i + a < n; ++a) {
      for (int j = 0; j < m; ++j) {
        for (int b = 0; b <= q && j + b < m; ++b) {
          const double x = normal(random);
          pair.band.row(i, a)[j * (q + 1) + b] = x;
          const auto set = [&](int i1, int j1, int i2, int j2) {
            pair.dense(i1 * m + j1, i2 * m + j2) = pair.dense(i2 * m + j2, i1 * m + j1) = x;
          };
          set(i, j, i + a, j + b);
          set(i, j + b, i + a, j);
        }
      }
    }
  }
  return pair;
}

TEST(TensorBandTest, IsTheMatrixOfItsNumbers) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const Pair pair = RandomPair(3 + seed % 7, 4 + seed % 5, 1 + seed % 3, 1 + seed % 4, seed);
    const Eigen::MatrixXd x = Eigen::MatrixXd::Random(pair.dense.rows(), 3);
    ThreadPool one(1), two(2);
    const Eigen::MatrixXd y = pair.band.Times(x, one);
    EXPECT_LT((y - pair.dense * x).cwiseAbs().maxCoeff(), kRounding * pair.dense.norm());
    EXPECT_EQ(pair.band.Times(x, two), y);
  }
}

// Rows that stand for one coefficient are added up, as around a ring.
TEST(TensorBandTest, AddsRowsThatRepeat) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const int n = 6 + seed % 5, m = 5 + seed % 4, p = 1 + seed % 3, q = 1 + seed % 2;
    // Around a ring as short as the reach some rows meet themselves.
    const int around = seed % 3 == 0 ? p : n - p, along = seed % 4 < 2 ? q : m;
    const Pair pair = RandomPair(n, m, p, q, seed);
    std::vector<int> outer, inner;
    for (int i = 0; i < n; ++i) outer.push_back(i % around);
    for (int j = 0; j < m; ++j) inner.push_back(j % along);
    BlockBandedMatrix matrix(around, along, around - 1);
    pair.band.AddTo(matrix, outer, inner);
    Eigen::MatrixXd gathers = Eigen::MatrixXd::Zero(around * along, n * m);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < m; ++j) gathers(outer[i] * along + inner[j], i * m + j) = 1;
    }
    const Eigen::MatrixXd found =
        matrix.Times(Eigen::MatrixXd::Identity(around * along, around * along));
    EXPECT_LT((found - gathers * pair.dense * gathers.transpose()).cwiseAbs().maxCoeff(),
              kRounding * pair.dense.norm());
  }
}

TEST(TensorBandTest, ABoxIsItsRowsAndColumns) {
  const int n = 9, m = 7;
  const Pair pair = RandomPair(n, m, 3, 2, 1);
  const NetBox box{2, 6, 1, 5};
  const BlockBandedMatrix part = pair.band.Of(box);
  const Eigen::MatrixXd found = part.Times(Eigen::MatrixXd::Identity(box.size(), box.size()));
  std::vector<Eigen::Index> rows;
  for (int i = box.outer; i < box.outer_end; ++i) {
    for (int j = box.inner; j < box.inner_end; ++j) rows.push_back(i * m + j);
  }
  EXPECT_EQ(found, pair.dense(rows, rows));
}

}  // namespace batten::internal::tensor_band_test
