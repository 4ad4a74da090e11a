// SPDX-License-Identifier: MIT
#include "fitting/surface/surface_preparation.h"

#include <gtest/gtest.h>

#include <numeric>

namespace batten::internal::surface_preparation_test {

// Points scattered over a domain of these sides, each its own parameters.
PreparedCloud Scattered(double length_u, double length_v, Eigen::Index count) {
  PreparedCloud prepared;
  prepared.base.length_u = length_u;
  prepared.base.length_v = length_v;
  const Eigen::Matrix2Xd share = (Eigen::Matrix2Xd::Random(2, count).array() + 1) / 2;
  prepared.base.parameters = Eigen::Vector2d(length_u, length_v).asDiagonal() * share;
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, count);
  points.topRows<2>() = share;
  prepared.merged.cloud = PointCloud(points);
  prepared.merged.place.resize(static_cast<size_t>(count));
  std::iota(prepared.merged.place.begin(), prepared.merged.place.end(), Eigen::Index{0});
  prepared.reached = prepared.used = PointMask::Constant(count, true);
  prepared.statistics.outliers = PointMask::Constant(count, false);
  return prepared;
}

TEST(SortByPlaceTest, KeepsEveryPointWithItsPlaceAndBringsNeighboursTogether) {
  constexpr Eigen::Index kCount = 4000;
  for (const double unit : {1e-170, 1e-3, 1.0, 1e170}) {
    for (const double aspect : {1.0, 20.0, 1e12}) {
      SCOPED_TRACE(testing::Message() << "unit " << unit << " aspect " << aspect);
      PreparedCloud prepared = Scattered(unit * aspect, unit, kCount);
      const Eigen::Matrix3Xd before = prepared.merged.cloud.points();
      SortByPlace(prepared);
      const Eigen::Matrix3Xd& after = prepared.merged.cloud.points();
      const Eigen::Vector2d sides(unit * aspect, unit);
      double between = 0, chance = 0;
      for (Eigen::Index k = 0; k < kCount; ++k) {
        EXPECT_EQ(after.col(prepared.merged.place[static_cast<size_t>(k)]), before.col(k));
        const Eigen::Vector2d share = prepared.base.parameters.col(k).cwiseQuotient(sides);
        EXPECT_LT((share - after.col(k).head<2>()).norm(), 1e-12);
        if (k == 0) continue;
        between += std::abs(after(0, k) - after(0, k - 1));
        chance += std::abs(before(0, k) - before(0, k - 1));
      }
      EXPECT_LT(between, 0.2 * chance);  // along the longer side at least
    }
  }
}

}  // namespace batten::internal::surface_preparation_test
