// SPDX-License-Identifier: MIT
#include "fitting/parameterization/lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "fitting/parameterization/plane_base.h"

namespace batten::internal::lattice_test {

// Heights over rows × columns nodes, with a share of them left out; x and y rounded to so much.
Eigen::Matrix3Xd Raster(int rows, int columns, double missing, double rounding, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform;
  Eigen::Matrix3Xd points(3, rows * columns);
  Eigen::Index count = 0;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      if (uniform(engine) < missing) continue;
      const Eigen::Vector2d place(512000 + 0.37 * i, 5403000 + 1.1 * j);
      points.col(count).head<2>() = (place / rounding).array().round() * rounding;
      points(2, count++) = 20 * std::sin(0.3 * i) + uniform(engine);  // steep
    }
  }
  points.conservativeResize(3, count);
  return points;
}

Eigen::Matrix3Xd Turned(const Eigen::Matrix3Xd& points, int axis) {
  Eigen::Matrix3Xd turned(3, points.cols());
  for (int d = 0; d < 3; ++d) turned.row((d + axis + 1) % 3) = points.row(d);
  return turned;
}

TEST(LatticeHeightsTest, FindsTheAxisOfRastersWithHolesAndFewDigits) {
  for (const double missing : {0.0, 0.3}) {
    for (const int axis : {0, 1, 2}) {
      SCOPED_TRACE(testing::Message() << missing << " missing, axis " << axis);
      const Eigen::Matrix3Xd points = Raster(60, 211, missing, 1e-4, 1);
      EXPECT_EQ(AxisOfLatticeHeights(Turned(points, axis)), axis);
    }
  }
}

TEST(LatticeHeightsTest, TakesNoOtherCloudForARaster) {
  const Eigen::Matrix3Xd raster = Raster(40, 50, 0, 1e-4, 1);
  Eigen::Matrix3Xd twice(3, raster.cols() + 1);  // two heights over a node
  twice << raster, raster.col(7) + Eigen::Vector3d::UnitZ();
  EXPECT_FALSE(AxisOfLatticeHeights(twice));
  Eigen::Matrix3Xd shaken = raster;
  shaken.topRows<2>() += 0.1 * Eigen::Matrix2Xd::Random(2, raster.cols());
  EXPECT_FALSE(AxisOfLatticeHeights(shaken));
  EXPECT_FALSE(AxisOfLatticeHeights(Raster(40, 50, 0.7, 1e-4, 1)));
  EXPECT_FALSE(AxisOfLatticeHeights(Eigen::Matrix3Xd::Random(3, 20000)));
  EXPECT_FALSE(AxisOfLatticeHeights(raster.leftCols(10)));
  Eigen::Matrix3Xd flat = raster;
  flat.row(0).setZero();
  EXPECT_FALSE(AxisOfLatticeHeights(flat));
}

// However steep its heights are, a raster is a height field over its own plane.
TEST(LatticeHeightsTest, IsThePlaneOfSteepRasters) {
  const Eigen::Matrix3Xd points = Raster(60, 60, 0.1, 1e-6, 2);
  ThreadPool pool(2);
  const PlaneBase base = FindPlaneBase(points, NeighbourIndex(points, pool), 0.6, 0.3, 1, pool);
  EXPECT_TRUE(base.lattice);
  EXPECT_EQ(base.overlap, 0);
  EXPECT_EQ(base.axes.col(2), Eigen::Vector3d::UnitZ());
}

}  // namespace batten::internal::lattice_test
