// SPDX-License-Identifier: MIT
#include "batten/io/write_cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cloud_bytes.h"

namespace batten::internal::write_cloud_test {

using ::testing::StartsWith;

constexpr unsigned kSeed = 11;

// Everything the formats keep without being asked comes back; u, v and w by their names.
void ExpectSameAfterReading(const PointCloud& cloud, const std::string& name) {
  SCOPED_TRACE(name);
  const TemporaryFolder folder;
  WriteCloud(cloud, folder.File(name));
  CloudReadOptions options;
  const bool numbered = name == "a.xyz" || name == "a.txt";
  options.columns = numbered
                        ? std::map<std::string, std::string>{{"x", "1"},
                                                             {"y", "2"},
                                                             {"z", "3"},
                                                             {"nx", "4"},
                                                             {"ny", "5"},
                                                             {"nz", "6"},
                                                             {"u", "10"},
                                                             {"v", "11"},
                                                             {"w", "12"}}
                        : std::map<std::string, std::string>{{"u", "u"}, {"v", "v"}, {"w", "w"}};
  const PointCloud back = ReadCloud({folder.File(name)}, options).cloud;
  EXPECT_EQ(World(back), World(cloud));
  EXPECT_EQ(back.points(), cloud.points());
  EXPECT_EQ(back.origin(), cloud.origin());
  EXPECT_EQ(back.normals(), cloud.normals());
  EXPECT_EQ(back.parameters(), cloud.parameters());
  EXPECT_EQ(back.weights(), cloud.weights());
  if (!numbered) {
    EXPECT_EQ(back.colours(), cloud.colours());
  }
}

TEST(WriteCloudTest, WritesWhatReadsBackBitForBitAtAnyScaleAndPlace) {
  std::mt19937_64 random(kSeed);
  SCOPED_TRACE(kSeed);
  for (const double scale : {1e-9, 1e-3, 1.0, 1e4, 1e9}) {
    const PointCloud cloud = RandomCloud(random, RandomPoints(random, 2000, scale));
    for (const char* name : {"a.ply", "a.pcd", "a.csv", "a.xyz", "a.txt"}) {
      ExpectSameAfterReading(cloud, name);
    }
  }
  const PointCloud utm =
      RandomCloud(random, RandomPoints(random, 2000, 50, {500000, 5400000, 300}));
  for (const char* name : {"a.ply", "a.pcd", "a.csv", "a.xyz"}) ExpectSameAfterReading(utm, name);
}

TEST(WriteCloudTest, KeepsPlaneCloudsPlaneInText) {
  const PointCloud cloud(Eigen::Matrix3Xd(Eigen::Vector3d(1, 2.5, 0)), Eigen::Vector3d::Zero(), 2);
  const TemporaryFolder folder;
  WriteCloud(cloud, folder.File("a.xyz"));
  EXPECT_EQ(folder.Text("a.xyz"), "1 2.5\n");
  WriteCloud(cloud, folder.File("a.csv"));
  EXPECT_EQ(folder.Text("a.csv"), "x,y\n1,2.5\n");
  EXPECT_EQ(ReadCloud({folder.File("a.csv")}).cloud.dimension(), 2);
  WriteCloud(cloud, folder.File("a.ply"));
  EXPECT_EQ(ReadCloud({folder.File("a.ply")}).cloud.World(0), Eigen::Vector3d(1, 2.5, 0));
}

TEST(WriteCloudTest, GoesByTheFormatWord) {
  const PointCloud cloud(Eigen::Matrix3Xd(Eigen::Vector3d(1, 2, 3)));
  const TemporaryFolder folder;
  WriteCloud(cloud, folder.File("a.any"), "ply");
  EXPECT_THAT(folder.Text("a.any"), StartsWith("ply\n"));
  EXPECT_THROW(WriteCloud(cloud, folder.File("a.step")), UsageError);
  EXPECT_THROW(WriteCloud(cloud, folder.File("a.laz")), UsageError);
  EXPECT_THROW(WriteCloud(cloud, folder.File("no/a.ply")), WriteError);
  EXPECT_EQ(folder.Entries(), 1);
}

}  // namespace batten::internal::write_cloud_test
