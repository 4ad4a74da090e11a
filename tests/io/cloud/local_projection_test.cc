// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
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
