// SPDX-License-Identifier: MIT
// One point stays in every cell that holds any, and a fit of thinned points is one of all of them.
#include "fitting/cloud/voxel_downsample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "batten/fitting/fit_surface.h"
#include "tolerances.h"

namespace batten::internal::voxel_downsample_test {

using Cell = std::array<double, 3>;

PointCloud RandomCloud(Eigen::Index count, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> real(-1, 1);
  Eigen::Matrix3Xd points(3, count);
  for (double& x : points.reshaped()) x = real(engine);
  PointCloud cloud(std::move(points), {1000, 2000, 3000});
  cloud.set_weights(Eigen::VectorXd::LinSpaced(count, 1, 2));
  return cloud;
}

Cell CellOf(const PointCloud& cloud, Eigen::Index k, double side) {
  const Eigen::Vector3d from = cloud.points().col(k) - cloud.points().rowwise().minCoeff();
  return {std::floor(from[0] / side), std::floor(from[1] / side), std::floor(from[2] / side)};
}

TEST(DownsampledCloudTest, KeepsThePointOfEachCellThatIsNearestToTheMean) {
  for (const double side : {0.05, 0.3, 1.0, 5.0}) {
    SCOPED_TRACE(side);
    const PointCloud cloud = RandomCloud(3000, 7);
    const DownsampledCloud thinned = Thinned(cloud, side);
    std::map<Cell, std::vector<Eigen::Index>> cells;
    for (Eigen::Index k = 0; k < cloud.size(); ++k) cells[CellOf(cloud, k, side)].push_back(k);
    ASSERT_EQ(thinned.cloud.size(), static_cast<Eigen::Index>(cells.size()));
    EXPECT_EQ(thinned.cloud.origin(), cloud.origin());
    for (const auto& [cell, members] : cells) {
      const Eigen::Index stands = thinned.stands[static_cast<size_t>(members[0])];
      const Eigen::Index kept = thinned.kept[static_cast<size_t>(stands)];
      EXPECT_EQ(thinned.cloud.points().col(stands), cloud.points().col(kept));
      EXPECT_EQ(thinned.cloud.weights()[stands], cloud.weights()[kept]);
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (const Eigen::Index k : members)
        mean += cloud.points().col(k) / static_cast<double>(members.size());
      for (const Eigen::Index k : members) {
        EXPECT_EQ(thinned.stands[static_cast<size_t>(k)], stands);
        EXPECT_LE((cloud.points().col(kept) - mean).norm(),
                  (cloud.points().col(k) - mean).norm() * (1 + kRounding));
      }
    }
  }
}

TEST(DownsampledCloudTest, CellsTooSmallOrTooLargeAreOrdinary) {
  const PointCloud cloud = RandomCloud(100, 8);
  EXPECT_EQ(Thinned(cloud, 1e-300).cloud.size(), 100);
  EXPECT_EQ(Thinned(PointCloud(cloud.points() * 1000), 1e-308).cloud.size(), 100);
  EXPECT_EQ(Thinned(cloud, 1e300).cloud.size(), 1);
  EXPECT_EQ(Thinned(PointCloud(), 1).cloud.size(), 0);
  EXPECT_THROW(Thinned(cloud, 0), std::invalid_argument);
  EXPECT_THROW(Thinned(cloud, -1), std::invalid_argument);
  EXPECT_THROW(Thinned(cloud, NAN), std::invalid_argument);
}

// A wavy sheet, dense on its left side, far from the origin, with noise.
TEST(DownsampledCloudTest, AFitOfThinnedPointsMeasuresAllOfThem) {
  std::mt19937_64 engine(9);
  std::uniform_real_distribution<double> real(0, 1);
  constexpr double kNoise = 0.001;
  std::normal_distribution<double> noise(0, kNoise);
  Eigen::Matrix3Xd points(3, 20000);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double x = k % 10 == 0 ? real(engine) : real(engine) / 4, y = real(engine);
    points.col(k) << 5e5 + x, 4e6 + y, 0.1 * std::sin(5 * x) * std::cos(4 * y) + noise(engine);
  }
  const PointCloud cloud = PointCloud::FromWorld(points);
  SurfaceFitOptions options{.tolerance = 6 * kNoise, .threads = 1};
  options.thin = 0.04;
  options.shift = {5e5, 4e6, 0};
  const SurfaceFit fit = FitSurface(cloud, options);
  ASSERT_TRUE(fit.report.input.thinned_to.has_value());
  const Eigen::Index kept = Thinned(cloud, 0.04).cloud.size();
  EXPECT_GE(*fit.report.input.thinned_to, kept);
  EXPECT_LT(*fit.report.input.thinned_to, cloud.size() / 4);
  EXPECT_LT(kept, 2000);
  EXPECT_EQ(fit.report.input.points, cloud.size());
  EXPECT_EQ(fit.report.input.used + fit.report.input.outliers, *fit.report.input.thinned_to);
  EXPECT_EQ(fit.report.error_all.points, cloud.size());
  ASSERT_EQ(fit.residuals.size(), cloud.size());
  double worst = 0;
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const Eigen::Vector2d at = fit.parameters.col(k);
    const Eigen::Vector3d foot = fit.surface.At(at[0], at[1]) + options.shift;
    // In world coordinates of 4e6 a double has ten digits behind the point.
    EXPECT_NEAR((foot - cloud.World(k)).norm(), std::abs(fit.residuals[k]), 4e6 * kRounding);
    worst = std::max(worst, std::abs(fit.residuals[k]));
  }
  EXPECT_DOUBLE_EQ(fit.report.error_all.max, worst);
  // Six deviations of the noise: also of the points beyond those that thinning keeps at the border.
  EXPECT_EQ(fit.report.error_all.out_of_tolerance, 0);
  EXPECT_LT(fit.report.error_all.rms, 1.5 * kNoise);
}

TEST(DownsampledCloudTest, MorePointsStandForThemselves) {
  const PointCloud cloud = RandomCloud(500, 10);
  const DownsampledCloud few = Thinned(cloud, 1);
  const std::vector<Eigen::Index> more{499, 3, few.kept[0], 3};
  const DownsampledCloud some = WithPoints(cloud, few, more);
  ASSERT_TRUE(std::is_sorted(some.kept.begin(), some.kept.end()));
  ASSERT_EQ(some.cloud.size(), std::ssize(some.kept));
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const Eigen::Index stands = some.kept[static_cast<size_t>(some.stands[static_cast<size_t>(k)])];
    const bool own = std::find(more.begin(), more.end(), k) != more.end();
    EXPECT_EQ(stands, own ? k : few.kept[static_cast<size_t>(few.stands[static_cast<size_t>(k)])]);
  }
}

// Mirrored, closed round a tube, at given parameters: every point has its distance.
TEST(DownsampledCloudTest, EveryRoadOfTheFitTakesThinnedPoints) {
  std::mt19937_64 engine(11);
  std::uniform_real_distribution<double> real(0, 1);
  Eigen::Matrix3Xd sheet(3, 6000), tube(3, 6000);
  Eigen::Matrix2Xd given(2, 6000);
  for (Eigen::Index k = 0; k < sheet.cols(); ++k) {
    const double x = real(engine), y = real(engine), angle = 2 * std::numbers::pi * x;
    sheet.col(k) << x, y - 0.5, 0.2 * x * x + y * (y - 1) / 4;
    tube.col(k) << std::cos(angle), std::sin(angle), 3 * y;
    given.col(k) << 10 * x, 5 * y;
  }
  SurfaceFitOptions options{.tolerance = 1e-3, .threads = 1};
  options.thin = 0.05;
  const auto expect_all = [&](const PointCloud& cloud) {
    const SurfaceFit fit = FitSurface(cloud, options);
    EXPECT_EQ(fit.report.error_all.points, cloud.size());
    EXPECT_EQ(fit.report.error_all.out_of_tolerance, 0);
    EXPECT_LT(*fit.report.input.thinned_to, cloud.size());
    EXPECT_EQ(fit.parameters.cols(), cloud.size());
  };
  {
    SCOPED_TRACE("tube");
    options.thin = 0.2;
    expect_all(PointCloud(tube));
  }
  options.thin = 0.05;
  {
    SCOPED_TRACE("given parameters");
    PointCloud cloud(sheet);
    cloud.set_parameters(given);
    options.given_parameters = true;
    expect_all(cloud);
    options.given_parameters = false;
  }
  {
    SCOPED_TRACE("mirrored");
    options.symmetric = MirrorPlane{Eigen::Vector3d::UnitY(), 0};
    expect_all(PointCloud(sheet));
  }
}

TEST(DownsampledCloudTest, TheOptionIsChecked) {
  SurfaceFitOptions options;
  options.thin = 0;
  EXPECT_THROW(Check(options), std::invalid_argument);
}

}  // namespace batten::internal::voxel_downsample_test
