// SPDX-License-Identifier: MIT
// The same cloud from every memory layout in which points are held.
#include "batten/fitting/cloud_rows.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "refusal.h"

namespace batten::internal::cloud_rows_test {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

Eigen::MatrixX3d Points() {
  Eigen::MatrixX3d rows(4, 3);
  rows << 1, 2, 3, 4, 5.5, 6, -7, 8, 9, 0, 0, 0.25;  // exact in single precision
  return rows;
}

void ExpectPoints(const PointCloud& cloud) {
  ASSERT_EQ(cloud.size(), 4);
  EXPECT_EQ(cloud.dimension(), 3);
  for (Eigen::Index k = 0; k < 4; ++k) EXPECT_EQ(cloud.World(k), Points().row(k).transpose());
}

TEST(CloudRowsTest, EveryLayoutGivesTheSamePoints) {
  const RowMajor rows = Points();
  ExpectPoints(CloudFromRows(Points()));
  ExpectPoints(CloudFromRows(rows));
  ExpectPoints(CloudFromRows(Points().cast<float>()));
  ExpectPoints(CloudFromRows(Eigen::Matrix3Xd(Points().transpose()).transpose()));

  // x y z and a fourth number that does not count, as in padded records.
  Eigen::Matrix<float, 4, 4, Eigen::RowMajor> padded;
  padded << Points().cast<float>(), Eigen::Vector4f::Ones();
  ExpectPoints(CloudFromRows(
      Eigen::Map<const Eigen::Matrix<float, 4, 3, Eigen::RowMajor>, 0, Eigen::OuterStride<4>>(
          padded.data())));
  ExpectPoints(CloudFromRows(padded.leftCols<3>()));

  const std::vector<double> doubles(rows.data(), rows.data() + rows.size());
  const std::vector<float> floats(doubles.begin(), doubles.end());
  ExpectPoints(CloudFromCoordinates(doubles));
  ExpectPoints(CloudFromCoordinates(floats));
}

TEST(CloudRowsTest, TwoColumnsArePointsOfThePlane) {
  const PointCloud cloud = CloudFromRows(Points().leftCols(2));
  EXPECT_EQ(cloud.dimension(), 2);
  EXPECT_EQ(cloud.World(1), Eigen::Vector3d(4, 5.5, 0));
  const std::vector<float> coordinates{1, 2, 3, 4};
  EXPECT_EQ(CloudFromCoordinates(coordinates, 2).World(1), Eigen::Vector3d(3, 4, 0));
}

TEST(CloudRowsTest, FarPointsKeepTheirLastDigits) {
  Eigen::MatrixX3d rows = Points();
  rows.col(0).array() += 5e6 + 1.0 / 1024;
  const PointCloud cloud = CloudFromRows(rows);
  EXPECT_GT(cloud.origin()[0], 1e6);
  for (Eigen::Index k = 0; k < 4; ++k) EXPECT_EQ(cloud.World(k), rows.row(k).transpose());
}

TEST(CloudRowsTest, RefusesWhatAreNoPoints) {
  EXPECT_NE(RefusalOf([] { CloudFromRows(Eigen::MatrixXd::Zero(5, 4)); }), "accepted");
  const std::vector<float> seven(7, 1.0F), four(4, 1.0F);
  EXPECT_NE(RefusalOf([&] { CloudFromCoordinates(seven); }), "accepted");
  EXPECT_NE(RefusalOf([&] { CloudFromCoordinates(four, 4); }), "accepted");
  Eigen::MatrixX3d rows = Points();
  rows(2, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(RefusalOf([&] { CloudFromRows(rows); }), "accepted");
}

}  // namespace batten::internal::cloud_rows_test
