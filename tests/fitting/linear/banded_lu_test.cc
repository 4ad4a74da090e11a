// SPDX-License-Identifier: MIT
#include "fitting/linear/banded_lu.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <string>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::banded_lu_test {

TEST(BandedLuTest, AgreesWithADenseSolution) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int size = random.Integer(1, 30), below = random.Integer(0, 6),
              above = random.Integer(0, 6);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(size, size);
    BandedLu banded(size, below, above);
    for (int i = 0; i < size; ++i) {
      for (int j = std::max(0, i - below); j <= std::min(size - 1, i + above); ++j) {
        // Small diagonals: rows must change places wherever the band allows it.
        const bool exchange = below > 0 && above > 0;
        dense(i, j) = random.Real(-1, 1) * (i == j && exchange ? 1e-3 : 1);
        banded.at(i, j) = dense(i, j);
      }
    }
    const Eigen::MatrixXd rhs = Eigen::MatrixXd::NullaryExpr(
        size, 3, [&](Eigen::Index, Eigen::Index) { return random.Real(-1, 1); });
    RightSides solution = rhs;
    ASSERT_EQ(banded.Factor(0), size);
    banded.Solve(solution);
    EXPECT_LE((dense * solution - rhs).norm(), kRounding * (1 + solution.norm()));
  }
}

TEST(BandedLuTest, SaysWhereAMatrixIsSingular) {
  BandedLu banded(5, 1, 1);
  for (int i = 0; i < 5; ++i) {
    if (i == 3) continue;  // nothing in this row and this column
    banded.at(i, i) = 2;
    if (i > 0 && i < 3) banded.at(i, i - 1) = banded.at(i - 1, i) = -1;
  }
  EXPECT_EQ(banded.Factor(1e-12), 3);
}

}  // namespace batten::internal::banded_lu_test
