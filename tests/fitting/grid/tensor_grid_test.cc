// SPDX-License-Identifier: MIT
#include "fitting/grid/tensor_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <string>

namespace batten::internal::tensor_grid_test {

// All pairs of rows × columns values, some left out, in any order.
Eigen::Matrix2Xd Pairs(int rows, int columns, int left_out, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::vector<int> cells(static_cast<size_t>(rows * columns));
  std::iota(cells.begin(), cells.end(), 0);
  std::shuffle(cells.begin(), cells.end(), engine);
  Eigen::Matrix2Xd pairs(2, rows * columns - left_out);
  for (Eigen::Index k = 0; k < pairs.cols(); ++k) {
    const int cell = cells[static_cast<size_t>(k)], row = cell / columns, column = cell % columns;
    pairs.col(k) << 0.1 * row * row, -3 + column / 7.0;
  }
  return pairs;
}

TEST(FindTensorGridTest, FindsTheOrderOfAGridThatWasShuffled) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const int left_out = seed % 2 == 0 ? 13 : 0;
    const Eigen::Matrix2Xd pairs = Pairs(9, 14, left_out, seed);
    const auto grid = FindTensorGrid(pairs);
    ASSERT_TRUE(grid);
    ASSERT_EQ(grid->rows, 9);
    ASSERT_EQ(grid->columns, 14);
    ASSERT_EQ(static_cast<Eigen::Index>(grid->order.size()), pairs.cols());
    ASSERT_EQ(grid->missing.size(), left_out > 0 ? 126 : 0);
    EXPECT_EQ(grid->missing.size() > 0 ? grid->missing.count() : 0, left_out);
    size_t next = 0;
    for (int cell = 0; cell < 126; ++cell) {
      if (left_out > 0 && grid->missing[cell]) continue;
      EXPECT_EQ(pairs(0, grid->order[next]), grid->u[cell / 14]);
      EXPECT_EQ(pairs(1, grid->order[next]), grid->v[cell % 14]);
      ++next;
    }
  }
}

TEST(FindTensorGridTest, TakesNothingElseForAGrid) {
  EXPECT_FALSE(FindTensorGrid(Eigen::Matrix2Xd::Random(2, 50)));
  EXPECT_FALSE(FindTensorGrid(Eigen::Matrix2Xd(2, 0)));
  Eigen::Matrix2Xd twice = Pairs(4, 5, 1, 1);
  twice.col(3) = twice.col(8);
  EXPECT_FALSE(FindTensorGrid(twice));
  EXPECT_FALSE(FindTensorGrid(Pairs(6, 6, 18, 2)));
  Eigen::Matrix2Xd line = Eigen::Matrix2Xd::Zero(2, 10);
  line.row(0).setLinSpaced(0, 1);
  EXPECT_FALSE(FindTensorGrid(line));
}

}  // namespace batten::internal::tensor_grid_test
