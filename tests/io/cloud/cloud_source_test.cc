// SPDX-License-Identifier: MIT
// Laws of files that are passed over: every pass gives what one reading gives, or says why not.
#include "batten/io/cloud_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "../temporary_folder.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "batten/io/write_cloud.h"

namespace batten::internal::cloud_source_test {

using ::testing::HasSubstr;

class CloudSourceTest : public ::testing::Test {
 protected:
  // Points whose coordinates single precision holds, in a file of each format that can be written.
  std::string File(const std::string& name, int points) {
    Eigen::Matrix3Xd rows(3, points);
    for (int k = 0; k < points; ++k) rows.col(k) << k % 1024, k / 1024, 0.25 * (k % 7);
    WriteCloud(PointCloud(rows), folder_.File(name), "");
    return folder_.File(name);
  }
  static Eigen::Matrix3Xd Passed(PointSource& source) {
    Eigen::Matrix3Xd all(3, 0);
    source.Pass([&](const Eigen::Matrix3Xd& points) {
      all.conservativeResize(3, all.cols() + points.cols());
      all.rightCols(points.cols()) = points;
    });
    return all;
  }
  static std::string ReasonOf(const std::function<void()>& act) {
    try {
      act();
    } catch (const std::exception& error) {
      return error.what();
    }
    return "nothing";
  }

  TemporaryFolder folder_;
};

TEST_F(CloudSourceTest, EveryPassGivesWhatReadingGives) {
  constexpr int kPieceAndSome = 70000;
  const std::vector<std::string> files = {File("a.ply", kPieceAndSome),
                                          File("b.pcd", 100),
                                          File("c.xyz", kPieceAndSome),
                                          File("d.csv", 100)};
  const Eigen::Matrix3Xd read = ReadCloud(files).cloud.points();
  CloudFileSource source(files);
  EXPECT_EQ(Passed(source), read);
  EXPECT_EQ(Passed(source), read);
  EXPECT_EQ(source.points_in_file(), read.cols());
}

TEST_F(CloudSourceTest, RowsAreKeptAndCountedAsInReading) {
  const std::string text =
      folder_.With("n.txt", "1 2 3 1\nnan 2 3 1\n4 5 6 2\n7 8 9 1\n20 0 0 1\n");
  CloudReadOptions options;
  options.where = {{"4", 1}};
  options.box = Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(10, 10, 10));
  const CloudFile file = ReadCloud({text}, options);
  CloudFileSource source({text}, options);
  EXPECT_EQ(Passed(source), file.cloud.points());
  EXPECT_EQ(source.points_in_file(), file.points_in_file);
  EXPECT_EQ(source.non_finite(), file.non_finite);
  EXPECT_EQ(source.filtered(), file.filtered);
}

TEST_F(CloudSourceTest, AFileThatChangesBetweenPassesIsNamed) {
  const std::string a = File("a.ply", 100), b = folder_.With("b.txt", "1 2 3\n4 5 6\n");
  {
    CloudFileSource source({a, b});
    Passed(source);
    folder_.With("b.txt", "1 2 3\n4 5 6\n7 8 9\n");
    EXPECT_THAT(
        ReasonOf([&] { Passed(source); }),
        HasSubstr(
            "b.txt: changed while it was passed over: it has another size (18 bytes, 12 before)"));
  }
  CloudFileSource source({a, b});
  Passed(source);
  const auto time = std::filesystem::last_write_time(b);
  folder_.With("b.txt", "1 2 3\n4 5 6\n7 8 8\n");
  std::filesystem::last_write_time(b, time);
  EXPECT_THAT(ReasonOf([&] { Passed(source); }),
              HasSubstr("b.txt: changed while it was passed over: it has other points"));
}

TEST_F(CloudSourceTest, WhatCannotBePassedOverIsRefused) {
  const std::string plane = folder_.With("plane.txt", "1 2\n3 4\n5 6\n"),
                    weighted = folder_.With("w.txt", "x y z w\n1 2 3 4\n5 6 7 8\n"),
                    mesh = folder_.With("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
                    empty = folder_.With("empty.txt", "");
  const auto reason = [&](const std::string& path) {
    return ReasonOf([&] {
      CloudFileSource source({path});
      Passed(source);
    });
  };
  EXPECT_THAT(reason(plane), HasSubstr("plane.txt: holds points in the plane"));
  EXPECT_THAT(reason(weighted), HasSubstr("w.txt: has weights"));
  EXPECT_THAT(reason(mesh), HasSubstr("is read whole"));
  EXPECT_THAT(reason(empty), HasSubstr("empty.txt: is empty"));
  EXPECT_THAT(reason("-"), HasSubstr("standard input can be read once only"));
  EXPECT_THAT(reason(folder_.File("none.ply")), HasSubstr("none.ply"));
  EXPECT_THROW(CloudFileSource(std::vector<std::string>{}), std::invalid_argument);
  CloudFileSource source({File("a.ply", 10), folder_.With("i.txt", "x y z i\n1 2 3 4\n")});
  Passed(source);
  ASSERT_EQ(source.warnings().size(), 1u);
  EXPECT_THAT(source.warnings()[0], HasSubstr("i.txt has the columns x y z i"));
}

TEST_F(CloudSourceTest, FilesThatSeemToBeInAnotherUnitAreNamed) {
  const auto file = [&](const std::string& name, double unit, double at) {
    std::string text;
    for (int k = 0; k < 100; ++k)
      text += std::to_string(unit * (at + k % 10)) + ' ' + std::to_string(unit * (at + k / 10)) +
              " 0\n";
    return folder_.With(name, text);
  };
  const auto warnings = [](const std::vector<std::string>& files) {
    CloudFileSource source(files);
    Passed(source);
    return source.warnings();
  };
  // Neighbours, a tile ten times as large, and a small one far away are of one unit.
  const std::string a = file("a.xyz", 1, 500), b = file("b.xyz", 1, 510),
                    large = file("large.xyz", 10, 50), mm = file("mm.xyz", 1000, 520);
  EXPECT_TRUE(warnings({a, b, large}).empty());
  EXPECT_TRUE(warnings({a, file("small.xyz", 0.01, 50000)}).empty());
  const std::vector<std::string> found = warnings({a, mm, b});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0], HasSubstr("mm.xyz are 1."));
  EXPECT_THAT(found[0], HasSubstr("reach 1e+03 times as far"));
}

}  // namespace batten::internal::cloud_source_test
