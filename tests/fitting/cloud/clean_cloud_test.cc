// SPDX-License-Identifier: MIT
#include "batten/fitting/clean_cloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>
#include <vector>

namespace batten::clean_cloud_test {

// A wavy sheet with points off it in a box about it, turned into some unit and moved.
Eigen::Matrix3Xd Sheet(int points, int stray, double unit, const Eigen::Vector3d& move) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(0, 1);
  Eigen::Matrix3Xd all(3, points + stray);
  for (int k = 0; k < points + stray; ++k) {
    const double x = place(random), y = place(random);
    all.col(k) << x, y, k < points ? 0.05 * std::sin(5 * x) : 0.3 + place(random);
  }
  return ((unit * all).colwise() + move).eval();
}

// The definition, by brute force in double.
std::vector<Eigen::Index> ByDefinition(const Eigen::Matrix3Xd& points, int k, double deviations) {
  std::vector<double> mean;
  for (const auto at : points.colwise()) {
    Eigen::VectorXd far = (points.colwise() - at).colwise().norm();
    std::sort(far.begin(), far.end());
    mean.push_back(far.segment(1, k).mean());
  }
  const Eigen::Map<const Eigen::VectorXd> means(mean.data(), points.cols());
  const double deviation = std::sqrt((means.array() - means.mean()).square().sum() /
                                     static_cast<double>(points.cols() - 1));
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (means[i] <= means.mean() + deviations * deviation) kept.push_back(i);
  return kept;
}

TEST(WithoutStatisticalOutliersTest, KeepsWhatTheDefinitionKeeps) {
  for (const int k : {1, 8, 16, 40}) {
    for (const double deviations : {0.5, 1.0, 3.0}) {
      SCOPED_TRACE(testing::Message() << k << " neighbours, " << deviations);
      const Eigen::Matrix3Xd points = Sheet(1500, 30, 1, {0, 0, 0});
      EXPECT_EQ(WithoutStatisticalOutliers(PointCloud::FromWorld(points), {k, deviations}),
                ByDefinition(points, k, deviations));
    }
  }
}

TEST(WithoutStatisticalOutliersTest, TakesUnitsAndOriginsAsTheyCome) {
  const auto kept =
      WithoutStatisticalOutliers(PointCloud::FromWorld(Sheet(3000, 60, 1, {0, 0, 0})));
  EXPECT_LE(std::ssize(kept), 3010);
  EXPECT_GE(std::count_if(kept.begin(), kept.end(), [](Eigen::Index k) { return k < 3000; }), 2990);
  for (const double unit : {1e-30, 1e3, 1e30}) {
    SCOPED_TRACE(unit);
    EXPECT_EQ(WithoutStatisticalOutliers(PointCloud::FromWorld(Sheet(3000, 60, unit, {0, 0, 0}))),
              kept);
  }
  const auto far =
      WithoutStatisticalOutliers(PointCloud::FromWorld(Sheet(3000, 60, 1, {4.5e5, 5.4e6, 300})));
  EXPECT_NEAR(static_cast<double>(far.size()), static_cast<double>(kept.size()), 1);
  // Without an origin of its own.
  EXPECT_EQ(WithoutStatisticalOutliers(PointCloud(Sheet(3000, 60, 1, {4.5e5, 5.4e6, 300}))), far);
}

TEST(WithoutStatisticalOutliersTest, KeepsAllWhereThereAreTooFewToTell) {
  for (const int points : {0, 1, 2, 16}) {
    std::vector<Eigen::Index> all(static_cast<std::size_t>(points));
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(WithoutStatisticalOutliers(PointCloud(Sheet(points, 0, 1, {0, 0, 0}))), all);
  }
  EXPECT_EQ(WithoutStatisticalOutliers(PointCloud(Eigen::Matrix3Xd::Ones(3, 100))).size(), 100U);
}

TEST(WithoutStatisticalOutliersTest, RefusesWhatIsNoRule) {
  const PointCloud cloud(Sheet(100, 0, 1, {0, 0, 0}));
  EXPECT_THROW(WithoutStatisticalOutliers(cloud, {0, 3}), std::invalid_argument);
  EXPECT_THROW(WithoutStatisticalOutliers(cloud, {16, 0}), std::invalid_argument);
  EXPECT_THROW(WithoutStatisticalOutliers(cloud, {16, HUGE_VAL}), std::invalid_argument);
}

}  // namespace batten::clean_cloud_test
