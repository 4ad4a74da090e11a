// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/io/cloud_source.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cloud_bytes.h"

namespace batten::internal::local_projection_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr unsigned kSeed = 7;
constexpr double kRadian = std::numbers::pi / 180, kEarth = 6.4e6;  // m

// Geocentric coordinates of a place on the ellipsoid [Bowring 1976]: an oracle without radii.
Eigen::Vector3d Geocentric(double longitude, double latitude) {
  const double a = 6378137, b = 6356752.314245;
  const double reduced = std::atan(b / a * std::tan(latitude * kRadian));
  return {a * std::cos(reduced) * std::cos(longitude * kRadian),
          a * std::cos(reduced) * std::sin(longitude * kRadian),
          b * std::sin(reduced)};
}

std::string Rows(const std::string& names, const Eigen::Matrix3Xd& points) {
  std::string text = names;
  for (const auto& p : points.colwise())
    text += std::to_string(p[0]) + "," + std::to_string(p[1]) + "," + std::to_string(p[2]) + "\n";
  return text;
}

// A plane that touches the earth: over a piece of size d lengths are off by d²/R, times tan φ.
TEST(LocalProjectionTest, KeepsDistancesOnTheEllipsoid) {
  std::mt19937_64 random(kSeed);
  SCOPED_TRACE(kSeed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const double reach : {0.001, 0.05}) {  // degrees
    for (int trial = 0; trial < 20; ++trial) {
      const double longitude = 180 * unit(random), latitude = 75 * unit(random);
      Eigen::Matrix3Xd degrees = RandomPoints(random, 30, reach, {longitude, latitude, 0});
      const CloudFile file = ReadBytes("a.csv", Rows("lon,lat,height\n", degrees));
      const Eigen::Matrix3Xd metres = World(file.cloud);
      // std::to_string writes six digits.
      degrees = (degrees * 1e6).array().round() / 1e6;
      const double size = 4 * reach * kRadian * kEarth;
      const double off = size * size / kEarth * (1 + std::abs(std::tan(latitude * kRadian)));
      for (int k = 1; k < 30; ++k) {
        const double truth =
            (Geocentric(degrees(0, k), degrees(1, k)) - Geocentric(degrees(0, 0), degrees(1, 0)))
                .norm();
        EXPECT_NEAR((metres.col(k) - metres.col(0)).head<2>().norm(), truth, off);
        EXPECT_EQ(metres(0, k) > metres(0, 0), degrees(0, k) > degrees(0, 0));
        EXPECT_EQ(metres(1, k) > metres(1, 0), degrees(1, k) > degrees(1, 0));
      }
      ASSERT_THAT(file.remarks, ElementsAre(HasSubstr("metres east and north")));
    }
  }
}

TEST(LocalProjectionTest, NamesInAnyOrderOrTheOptionAskForIt) {
  const Eigen::Matrix3Xd named =
      World(ReadBytes("a.csv", "lon,lat,z\n8.5,47,3\n8.6,47.1,4\n").cloud);
  EXPECT_GT(named(0, 1) - named(0, 0), 7000);
  EXPECT_EQ(named.row(2), Eigen::RowVector2d(3, 4));
  EXPECT_EQ(World(ReadBytes("a.csv", "Height;LATITUDE;Longitude\n3;47;8,5\n4;47,1;8,6\n").cloud),
            named);
  CloudReadOptions options;
  options.projection = CloudProjection::kLocal;
  EXPECT_EQ(World(ReadBytes("a.xyz", "8.5 47 3\n8.6 47.1 4\n", options).cloud), named);
  options.columns = {{"x", "2"}, {"y", "1"}};
  EXPECT_EQ(World(ReadBytes("a.xyz", "47 8.5 3\n47.1 8.6 4\n", options).cloud).topRows(2),
            named.topRows(2));
  options = {};
  options.projection = CloudProjection::kNone;
  const CloudFile kept = ReadBytes("a.csv", "lon,lat,z\n8.5,47,3\n8.6,47.1,4\n", options);
  EXPECT_EQ(kept.cloud.World(1), Eigen::Vector3d(8.6, 47.1, 4));
  EXPECT_THAT(kept.remarks, IsEmpty());
}

TEST(LocalProjectionTest, APieceAcrossTheDateLineStaysOnePiece) {
  const Eigen::Matrix3Xd points =
      World(ReadBytes("a.csv", "lon,lat\n179.9,-17\n-179.9,-17\n180,-17\n").cloud);
  EXPECT_NEAR(points(0, 1) - points(0, 0), 2 * (points(0, 2) - points(0, 0)), 1e-6);
  EXPECT_GT(points(0, 1), points(0, 0));
}

// Metres about one place are the same for every choice of points: to the last bit.
TEST(LocalProjectionTest, APlaceThatIsGivenHoldsForAnyPoints) {
  const std::string names = "lon,lat,z\n", west = "10.001,48.002,3\n10.002,48.001,4\n",
                    east = "10.013,48.012,5\n";
  const CloudFile all = ReadBytes("a.csv", names + west + east);
  ASSERT_TRUE(all.projection_middle);
  EXPECT_EQ(*all.projection_middle, Eigen::Vector2d(10.007, 48.0065));
  ASSERT_THAT(all.remarks, ElementsAre(HasSubstr("(--projection local=10.00700,48.00650)")));
  CloudReadOptions options;
  TakeProjection("local=10.00700,48.00650", options);  // as the remark has it
  EXPECT_EQ(World(ReadBytes("a.csv", names + west + east, options).cloud), World(all.cloud));
  const CloudFile half = ReadBytes("a.csv", names + west, options);
  EXPECT_EQ(World(half.cloud), World(all.cloud).leftCols(2));
  EXPECT_EQ(half.projection_middle, all.projection_middle);
  EXPECT_NE(ReadBytes("a.csv", names + west).projection_middle, all.projection_middle);
  TakeProjection("local=179.99,-17", options);
  EXPECT_GT(World(ReadBytes("a.csv", "lon,lat\n-179.99,-17\n", options).cloud)(0, 0), 2000);
}

TEST(LocalProjectionTest, TakesItsWords) {
  CloudReadOptions options;
  TakeProjection("local=-10.5,4e1", options);
  EXPECT_EQ(options.projection, CloudProjection::kLocal);
  EXPECT_EQ(options.projection_middle, Eigen::Vector2d(-10.5, 40));
  TakeProjection("local", options);
  EXPECT_EQ(options.projection, CloudProjection::kLocal);
  EXPECT_FALSE(options.projection_middle);
  TakeProjection("none", options);
  EXPECT_EQ(options.projection, CloudProjection::kNone);
  for (const char* word : {"",
                           "Local",
                           "local=",
                           "local=1",
                           "local=1,",
                           "local=1,2,3",
                           "local=1;2",
                           "local=1,91",
                           "local=1e3,2",
                           "local=nan,2",
                           "local=1,nan",
                           "local=x,2"}) {
    EXPECT_THROW(TakeProjection(word, options), std::invalid_argument) << word;
  }
}

// 200 degrees of longitude near the equator, from the west on and from their middle on.
TEST(LocalProjectionTest, LongitudesAreCutWhereThereAreNone) {
  std::vector<std::string> rows;
  for (int k = -100; k <= 100; ++k) rows.push_back(std::to_string(k) + ",1,0\n");
  const auto width = [&](int first) {
    std::string text = "lon,lat,z\n";
    for (int k = 0; k < 201; ++k) text += rows[static_cast<std::size_t>((first + k) % 201)];
    const CloudFile file = ReadBytes("a.csv", text);
    EXPECT_EQ(*file.projection_middle, Eigen::Vector2d(0, 1));
    const Eigen::Matrix3Xd points = World(file.cloud);
    return points.row(0).maxCoeff() - points.row(0).minCoeff();
  };
  EXPECT_EQ(width(0), width(100));
  EXPECT_EQ(width(0), width(200));
  EXPECT_NEAR(width(0), 200 * kRadian * 6378137, 200 * kRadian * kEarth * 1e-3);
}

TEST(LocalProjectionTest, RefusesPiecesTooLargeForTrueLengths) {
  for (const char* rows : {"0,89.99999\n90,89.99999\n180,89.99999\n270,89.99999\n",  // round a pole
                           "0,90\n120,90\n-120,90\n",
                           "10,89\n10.01,89.9\n",
                           "10,-20\n10,60\n",
                           "-120,70\n-60,70\n0,70\n",
                           "0,0\n1,80\n-170,-80\n100,20\n"}) {
    EXPECT_THAT(FailureOf("a.csv", std::string("lon,lat\n") + rows),
                AllOf(HasSubstr("a.csv"), HasSubstr("off by more than 1 %"), HasSubstr("--box")))
        << rows;
  }
  CloudReadOptions options;
  TakeProjection("local=10,0", options);
  EXPECT_THROW(ReadBytes("a.csv", "lon,lat\n10,48\n10.1,48.1\n", options), ReadError);
}

TEST(LocalProjectionTest, DegreesWithoutNamesStayWithAWord) {
  const char* const text = "-94.663 31.036 47\n-94.664 31.037 52\n-94.662 31.035 60\n";
  const CloudFile file = ReadBytes("a.xyz", text);
  EXPECT_EQ(file.cloud.World(0), Eigen::Vector3d(-94.663, 31.036, 47));
  EXPECT_THAT(file.remarks,
              ElementsAre(AllOf(HasSubstr("degrees"), HasSubstr("--projection local"))));
  for (const char* other : {"-94.663 31.036 47\n-94.664 31.037 47.1\n",  // a height as small
                            "-0.01 0.01 47\n0.01 -0.01 152\n",           // a rod about zero
                            "200.663 31.036 47\n200.664 31.037 52\n",    // no longitude
                            "50.663 91.036 47\n50.664 91.037 52\n",      // no latitude
                            "-94.663 31.036\n-94.664 31.037\n"}) {
    EXPECT_THAT(ReadBytes("a.xyz", other).remarks, IsEmpty()) << other;
  }
}

TEST(LocalProjectionTest, RefusesWhatIsNotDegreesNamingTheValue) {
  EXPECT_THAT(FailureOf("a.csv", "lon,lat\n8,47\n8,470\n"),
              AllOf(HasSubstr("a.csv"), HasSubstr("latitude 470"), HasSubstr("--projection none")));
  const TemporaryFolder folder;
  const std::vector<std::string> paths{folder.With("a.csv", "x,y,z\n1,2,3\n"),
                                       folder.With("b.csv", "lon,lat,z\n1,2,3\n")};
  EXPECT_THROW(ReadCloud(paths), ReadError);
  CloudFileSource source({paths[1]});
  EXPECT_THROW(source.Pass([](const Eigen::Matrix3Xd&) {}), ReadError);
}

}  // namespace batten::internal::local_projection_test
