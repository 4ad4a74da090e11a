// SPDX-License-Identifier: MIT
#include "fitting/surface/surface_folds.h"

#include <gtest/gtest.h>

#include <cmath>

#include "random_splines.h"

namespace batten::internal::surface_folds_test {

TEST(SurfaceFoldsTest, AreNoneOnHeightFields) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    RandomSplines random(seed);
    const NurbsSurface sheet = random.Sheet(random.Integer(1, 4), random.Integer(1, 4), 0.05);
    EXPECT_EQ(FoldedPairs(sheet), 0) << seed;
  }
}

// A line of control points that passes the next one makes the edge run back.
TEST(SurfaceFoldsTest, AreFoundWhereAnEdgeRunsBack) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    RandomSplines random(seed);
    const NurbsSurface sheet = random.Sheet(3, 3, 0.05);
    Eigen::Matrix3Xd net = sheet.control_points();
    const Eigen::Index row = random.Integer(0, sheet.size_u() - 1) * Eigen::Index{sheet.size_v()};
    const Eigen::Vector3d along = net.col(row + sheet.size_v() - 1) - net.col(row);
    net.col(row) += 1.5 * along;
    const NurbsSurface folded(sheet.basis_u(), sheet.basis_v(), net);
    EXPECT_GT(FoldedPairs(folded), 0) << seed;
  }
}

}  // namespace batten::internal::surface_folds_test
