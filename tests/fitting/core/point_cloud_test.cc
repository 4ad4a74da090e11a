// SPDX-License-Identifier: MIT
#include "batten/fitting/point_cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"
#include "refusal.h"
#include "geometry/numeric/constants.h"

namespace batten::internal::point_cloud_test {

using testing::HasSubstr;
using Mask = Eigen::Array<bool, Eigen::Dynamic, 1>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Eigen::Matrix3Xd RandomPoints(RandomSplines& random, Eigen::Index count, double half_side = 1) {
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index k = 0; k < count; ++k) points.col(k) = random.Vector(half_side);
  return points;
}

// A cloud that carries everything, no two points of which carry the same.
PointCloud FullCloud(Eigen::Matrix3Xd points, RandomSplines& random) {
  const Eigen::Index m = points.cols();
  PointCloud cloud(std::move(points), Eigen::Vector3d(1e6, -2e6, 3));
  cloud.set_normals(RandomPoints(random, m));
  cloud.set_weights(random.Weights(m));
  PointCloud::Colours colours(3, m);
  for (std::uint8_t& c : colours.reshaped()) c = static_cast<std::uint8_t>(random.Integer(0, 255));
  cloud.set_colours(colours);
  cloud.set_parameters(RandomPoints(random, m).topRows<2>());
  return cloud;
}

TEST(PointCloudTest, GivesWorldCoordinatesBackBitForBitWhereverTheCloudLies) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Eigen::Vector3d size(random.Logarithmic(1e-3, 1e3),
                               random.Logarithmic(1e-3, 1e3),
                               random.Coin() ? 0 : random.Logarithmic(1e-3, 1e3));
    const Eigen::Vector3d middle = random.Vector(random.Logarithmic(1, 1e8));
    const Eigen::Matrix3Xd world =
        (size.asDiagonal() * RandomPoints(random, random.Integer(1, 50))).colwise() + middle;
    const PointCloud cloud = PointCloud::FromWorld(world);
    ASSERT_EQ(cloud.size(), world.cols());
    for (Eigen::Index k = 0; k < world.cols(); ++k) EXPECT_EQ(cloud.World(k), world.col(k));
  }
}

TEST(PointCloudTest, SplitsAnOriginOffThatLiesAmongTheFarPoints) {
  RandomSplines random(1);
  const Eigen::Vector3d place(500000, 5400000, 3000);
  const Eigen::Matrix3Xd world = RandomPoints(random, 100, 25).colwise() + place;
  const PointCloud cloud = PointCloud::FromWorld(world);
  EXPECT_LE((cloud.origin() - place).cwiseAbs().maxCoeff(), 50);
  EXPECT_LE(cloud.points().cwiseAbs().maxCoeff(), 50);
}

TEST(PointCloudTest, KeepsTenthsOfMillimetresOfGeoreferencedPoints) {
  // Doubles near 5.4e6 are 2^-30 ≈ 1e-9 apart: ripples of 1e-4 survive to that, and no better.
  constexpr double kStepOfWorldCoordinates = 0x1p-30;
  const Eigen::Vector3d place(500000, 5400000, 300);
  RandomSplines random(2);
  Eigen::Matrix3Xd ripples = RandomPoints(random, 500, 5);
  for (Eigen::Index k = 0; k < ripples.cols(); ++k) ripples(2, k) = 1e-4 * random.Integer(0, 9);
  const PointCloud cloud = PointCloud::FromWorld(ripples.colwise() + place);
  for (Eigen::Index k = 1; k < ripples.cols(); ++k) {
    const Eigen::Vector3d kept = cloud.points().col(k) - cloud.points().col(0);
    const Eigen::Vector3d meant = ripples.col(k) - ripples.col(0);
    EXPECT_LE((kept - meant).cwiseAbs().maxCoeff(), kStepOfWorldCoordinates) << "point " << k;
  }
}

TEST(PointCloudTest, LeavesCloudsNearZeroWhereTheyAre) {
  RandomSplines random(3);
  const Eigen::Matrix3Xd world =
      RandomPoints(random, 50, 10).colwise() + Eigen::Vector3d(30, -70, 0);
  const PointCloud cloud = PointCloud::FromWorld(world);
  EXPECT_EQ(cloud.origin(), Eigen::Vector3d::Zero());
  EXPECT_EQ(cloud.points(), world);
}

TEST(PointCloudTest, TakesEmptyCloudsAndSinglePoints) {
  EXPECT_EQ(PointCloud::FromWorld(Eigen::Matrix3Xd(3, 0)).size(), 0);
  const PointCloud zero = PointCloud::FromWorld(Eigen::Matrix3Xd::Zero(3, 1));
  EXPECT_EQ(zero.World(0), Eigen::Vector3d::Zero());
  const PointCloud widest =
      PointCloud::FromWorld(Eigen::Matrix3Xd{{-1e308, 1e308}, {-1e308, 1e308}, {0, 0}});
  EXPECT_EQ(widest.World(1), Eigen::Vector3d(1e308, 1e308, 0));
}

TEST(PointCloudTest, RefusesWhatIsNotFinite) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 4);
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    points(1, 2) = bad;
    EXPECT_THAT(RefusalOf([&] { PointCloud cloud(points); }), HasSubstr("point"));
    EXPECT_THAT(RefusalOf([&] { PointCloud::FromWorld(points); }), HasSubstr("point"));
    EXPECT_THAT(RefusalOf([&] {
                  PointCloud(Eigen::Matrix3Xd(3, 0), {0, bad, 0});
                }),
                HasSubstr("origin"));
  }
}

TEST(PointCloudTest, RefusesDimensionsOtherThanTwoAndThree) {
  for (const int dimension : {-1, 0, 1, 4}) {
    EXPECT_THAT(RefusalOf([&] {
                  PointCloud(Eigen::Matrix3Xd::Zero(3, 1), Eigen::Vector3d::Zero(), dimension);
                }),
                HasSubstr("dimension"));
  }
}

TEST(PointCloudTest, RefusesPropertiesOfTheWrongNumberAndSaysWhich) {
  PointCloud cloud(Eigen::Matrix3Xd::Zero(3, 4));
  EXPECT_THAT(RefusalOf([&] { cloud.set_normals(Eigen::Matrix3Xd::Ones(3, 3)); }),
              HasSubstr("normals"));
  EXPECT_THAT(RefusalOf([&] { cloud.set_weights(Eigen::VectorXd::Ones(5)); }), HasSubstr("weights"));
  EXPECT_THAT(RefusalOf([&] { cloud.set_colours(PointCloud::Colours::Zero(3, 1)); }),
              HasSubstr("colours"));
  EXPECT_THAT(RefusalOf([&] { cloud.set_parameters(Eigen::Matrix2Xd::Zero(2, 3)); }),
              HasSubstr("parameters"));
  EXPECT_EQ(cloud.normals().cols(), 0) << "a refused property leaves the cloud as it was";
}

TEST(PointCloudTest, RefusesPropertiesThatAreNotFinite) {
  PointCloud cloud(Eigen::Matrix3Xd::Zero(3, 4));
  for (const double bad : {kNaN, kInfinity}) {
    Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Ones(3, 4);
    normals(0, 3) = bad;
    EXPECT_THAT(RefusalOf([&] { cloud.set_normals(normals); }), HasSubstr("normal"));
    EXPECT_THAT(RefusalOf([&] { cloud.set_parameters(normals.topRows<2>()); }),
                HasSubstr("parameter"));
    EXPECT_THAT(RefusalOf([&] { cloud.set_weights(normals.row(0)); }), HasSubstr("weight"));
  }
}

TEST(PointCloudTest, RefusesWeightsThatAreNotPositive) {
  PointCloud cloud(Eigen::Matrix3Xd::Zero(3, 3));
  for (const double bad : {0.0, -0.0, -1.0}) {
    EXPECT_THAT(RefusalOf([&] { cloud.set_weights(Eigen::Vector3d(1, bad, 1)); }),
                HasSubstr("positive"));
  }
}

TEST(PointCloudTest, DropsAPropertyThatIsSetEmpty) {
  RandomSplines random(4);
  PointCloud cloud = FullCloud(RandomPoints(random, 5), random);
  cloud.set_weights({});
  cloud.set_normals(Eigen::Matrix3Xd(3, 0));
  EXPECT_EQ(cloud.weights().size(), 0);
  EXPECT_EQ(cloud.normals().cols(), 0);
}

TEST(PointCloudTest, KeepsEverythingThatBelongsToThePointsOfASubset) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const PointCloud cloud = FullCloud(RandomPoints(random, random.Integer(1, 40)), random);
    Mask keep(cloud.size());
    for (bool& k : keep) k = random.Coin();
    const PointCloud subset = cloud.Subset(keep);
    ASSERT_EQ(subset.size(), keep.count());
    EXPECT_EQ(subset.origin(), cloud.origin());
    EXPECT_EQ(subset.dimension(), cloud.dimension());
    for (Eigen::Index k = 0, kept = 0; k < cloud.size(); ++k) {
      if (!keep[k]) continue;
      EXPECT_EQ(subset.points().col(kept), cloud.points().col(k));
      EXPECT_EQ(subset.normals().col(kept), cloud.normals().col(k));
      EXPECT_EQ(subset.weights()[kept], cloud.weights()[k]);
      EXPECT_EQ(subset.colours().col(kept), cloud.colours().col(k));
      EXPECT_EQ(subset.parameters().col(kept), cloud.parameters().col(k));
      ++kept;
    }
  }
}

TEST(PointCloudTest, RefusesAMaskOfTheWrongSize) {
  const PointCloud cloud(Eigen::Matrix3Xd::Zero(3, 3));
  EXPECT_THAT(RefusalOf([&] { cloud.Subset(Mask::Constant(2, true)); }), HasSubstr("mask"));
}

// A cloud in which most places hold several points.
PointCloud RandomDuplicates(RandomSplines& random) {
  Eigen::Matrix3Xd points(3, random.Integer(1, 200));
  for (double& x : points.reshaped()) x = random.Integer(0, 3);
  return FullCloud(std::move(points), random);
}

TEST(MergeDuplicatesTest, LeavesOnePointForEachPlace) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const PointCloud cloud = RandomDuplicates(random);
    const MergedCloud merged = MergeDuplicates(cloud);
    std::map<std::tuple<double, double, double>, int> places;
    for (const auto& p : merged.cloud.points().colwise()) ++places[{p[0], p[1], p[2]}];
    for (const auto& [place, count] : places) EXPECT_EQ(count, 1);
    EXPECT_EQ(merged.cloud.size() + merged.duplicates, cloud.size());
  }
}

TEST(MergeDuplicatesTest, SendsEveryPointToAnEqualOneAndKeepsTheOrder) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const PointCloud cloud = RandomDuplicates(random);
    const MergedCloud merged = MergeDuplicates(cloud);
    ASSERT_EQ(std::ssize(merged.place), cloud.size());
    Eigen::Index newest = -1;
    for (Eigen::Index k = 0; k < cloud.size(); ++k) {
      const Eigen::Index place = merged.place[k];
      ASSERT_LT(place, merged.cloud.size());
      EXPECT_EQ(merged.cloud.World(place), cloud.World(k));
      EXPECT_LE(place, newest + 1) << "places are numbered as they first occur";
      if (place > newest) {  // the first point of a place lends it what it carries
        EXPECT_EQ(merged.cloud.normals().col(place), cloud.normals().col(k));
        EXPECT_EQ(merged.cloud.colours().col(place), cloud.colours().col(k));
        EXPECT_EQ(merged.cloud.parameters().col(place), cloud.parameters().col(k));
        newest = place;
      }
    }
  }
}

TEST(MergeDuplicatesTest, AddsTheWeightsUp) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    PointCloud cloud = RandomDuplicates(random);
    if (random.Coin()) cloud.set_weights({});
    const MergedCloud merged = MergeDuplicates(cloud);
    if (merged.duplicates == 0) continue;
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(merged.cloud.size());
    for (Eigen::Index k = 0; k < cloud.size(); ++k) {
      sums[merged.place[k]] += cloud.weights().size() > 0 ? cloud.weights()[k] : 1;
    }
    ASSERT_EQ(merged.cloud.weights().size(), sums.size());
    EXPECT_LE((merged.cloud.weights() - sums).cwiseAbs().maxCoeff(), kRounding * sums.maxCoeff());
  }
}

TEST(MergeDuplicatesTest, ChangesNothingWhereAllPointsDiffer) {
  RandomSplines random(5);
  const Eigen::Matrix3Xd points = RandomPoints(random, 100);
  const MergedCloud merged = MergeDuplicates(PointCloud(points));
  EXPECT_EQ(merged.duplicates, 0);
  EXPECT_EQ(merged.cloud.points(), points);
  EXPECT_EQ(merged.cloud.weights().size(), 0) << "no weights are made up";
  EXPECT_EQ(MergeDuplicates(PointCloud()).cloud.size(), 0);
}

TEST(MergeDuplicatesTest, CountsBothZerosAsOnePlace) {
  const MergedCloud merged =
      MergeDuplicates(PointCloud(Eigen::Matrix3Xd{{0.0, -0.0}, {1, 1}, {-0.0, 0.0}}));
  EXPECT_EQ(merged.cloud.size(), 1);
}

}  // namespace batten::internal::point_cloud_test
