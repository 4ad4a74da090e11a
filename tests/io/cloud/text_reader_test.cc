// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cloud_bytes.h"

namespace batten::internal::text_reader_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr unsigned kSeed = 11;

// The two points (1, 2, 3) and (−4, 5.5, 0.06) of every spelling below.
const Eigen::Matrix3Xd& TwoPoints() {
  static const Eigen::Matrix3Xd points =
      (Eigen::Matrix3Xd(3, 2) << 1, -4, 2, 5.5, 3, 0.06).finished();
  return points;
}

TEST(TextReaderTest, TakesAnySeparatorCommentAndLineEnd) {
  for (const char* text : {"1 2 3\n-4 5.5 .06\n",
                           "1\t2\t3\n-4\t5.5\t0.06",
                           "1,2,3\r\n-4,5.5,6e-2\r\n",
                           "1; 2 ;3\n  -4;+5.5;6E-02  \n\n",
                           "# x y z\n1 2 3 # first\n// more\n-4 5.5 0.06//second\n",
                           "\xEF\xBB\xBFx,y,z\n1,2,3\n-4,5.5,0.06\n",
                           "\xEF\xBB\xBF"
                           "1 2 3\n-4 5.5 0.06\n",
                           "\"X\";\"Y\";\"Z\"\n\"1\";\"2\";\"3\"\n-4;5.5;0.06\n",
                           "2\n1 2 3 99\n-4 5.5 0.06 98\n",
                           "A title of some words\n1 2 3\n-4 5.5 0.06\n",
                           "1 2 3 wall\n-4 5.5 0.06 floor\n"}) {
    const CloudFile file = ReadBytes("a.txt", text);
    EXPECT_EQ(World(file.cloud), TwoPoints()) << text;
    EXPECT_EQ(file.cloud.dimension(), 3);
    EXPECT_EQ(file.points_in_file, 2);
  }
}

TEST(TextReaderTest, ReadsEveryTextExtensionAlike) {
  for (const char* name : {"a.xyz", "a.txt", "a.CSV", "a.asc", "a.pts", "a.dat"}) {
    EXPECT_EQ(World(ReadBytes(name, "1 2 3\n-4 5.5 .06\n").cloud), TwoPoints()) << name;
  }
  CloudReadOptions options;
  options.format = "text";
  EXPECT_EQ(World(ReadBytes("a.points", "1 2 3 7\n-4 5.5 .06 8\n", options).cloud), TwoPoints());
}

TEST(TextReaderTest, FindsColumnsByTheHeaderWhateverTheirOrder) {
  const CloudFile file = ReadBytes("a.csv",
                                   "weight,Z,NX,ny,Normal_Z,Red,g,b,Y,x,v,U\n"
                                   "2,3,0,0.6,0.8,255,128,0,2,1,0.2,0.1\n"
                                   "4,0.06,1,0,0,1,2,3,5.5,-4,0.4,0.3\n");
  const PointCloud& cloud = file.cloud;
  EXPECT_EQ(World(cloud), TwoPoints());
  EXPECT_EQ(cloud.normals().col(0), Eigen::Vector3d(0, 0.6, 0.8));
  EXPECT_EQ(cloud.weights(), Eigen::Vector2d(2, 4));
  EXPECT_EQ(cloud.parameters().col(1), Eigen::Vector2d(0.3, 0.4));
  EXPECT_EQ(cloud.colours().col(0).cast<int>(), Eigen::Vector3i(255, 128, 0));
  EXPECT_THAT(file.fields, ::testing::Contains("Normal_Z"));
}

TEST(TextReaderTest, NamesFieldsByNumberWithoutAHeader) {
  EXPECT_THAT(ReadBytes("a.xyz", "1 2 3 4\n").fields, ElementsAre("1", "2", "3", "4"));
}

TEST(TextReaderTest, ExtensionsThatNameTheColumnsAreTakenAtTheirWord) {
  const CloudFile given = ReadBytes("a.uvxyz", "0.1 0.2 1 2 3\n0.3 0.4 -4 5.5 .06\n");
  EXPECT_EQ(World(given.cloud), TwoPoints());
  EXPECT_EQ(given.cloud.parameters().col(1), Eigen::Vector2d(0.3, 0.4));
  EXPECT_THAT(given.fields, ElementsAre("u", "v", "x", "y", "z"));

  CloudReadOptions ground;
  ground.where = {{"label", 1}};
  const CloudFile labelled =
      ReadBytes("a.XYZL", "1 2 3 1 77\n9 9 9 0 77\n-4 5.5 .06 1 77\n", ground);
  EXPECT_EQ(World(labelled.cloud), TwoPoints());
  EXPECT_EQ(labelled.filtered, 1);
  EXPECT_THAT(labelled.fields, ElementsAre("x", "y", "z", "label", "5"));

  EXPECT_EQ(ReadBytes("a.xyzn", "1 2 3 0 0.6 0.8\n").cloud.normals().col(0),
            Eigen::Vector3d(0, 0.6, 0.8));
  EXPECT_EQ(ReadBytes("a.xyzrgb", "1 2 3 255 128 0\n").cloud.colours().col(0).cast<int>(),
            Eigen::Vector3i(255, 128, 0));
  const CloudFile scanner = ReadBytes("a.pts", "2\n1 2 3 -700 255 128 0\n-4 5.5 .06 9 1 2 3\n");
  EXPECT_EQ(World(scanner.cloud), TwoPoints());
  EXPECT_EQ(scanner.cloud.colours().col(1).cast<int>(), Eigen::Vector3i(1, 2, 3));
  EXPECT_EQ(ReadBytes("a.xyz", "1 2 3 255 128 0\n").cloud.colours().cols(), 0);
}

TEST(TextReaderTest, HeadersAndOptionsOverruleTheExtension) {
  EXPECT_EQ(World(ReadBytes("a.uvxyz", "x y z u v\n1 2 3 .1 .2\n-4 5.5 .06 .3 .4\n").cloud),
            TwoPoints());
  EXPECT_EQ(World(ReadBytes("a.uvxyz", "# x y z u v\n1 2 3 .1 .2\n-4 5.5 .06 .3 .4\n").cloud),
            TwoPoints());
  CloudReadOptions options;
  options.columns = {{"x", "2"}, {"y", "3"}, {"z", "4"}, {"u", "1"}, {"v", "5"}};
  const CloudFile asked = ReadBytes("a.uvxyz", ".1 1 2 3 .2\n.3 -4 5.5 .06 .4\n", options);
  EXPECT_EQ(World(asked.cloud), TwoPoints());
  EXPECT_EQ(asked.cloud.parameters().col(0), Eigen::Vector2d(0.1, 0.2));
}

// Three columns named u v x y z would be a point in the wrong place.
TEST(TextReaderTest, RefusesFewerColumnsThanTheExtensionNames) {
  EXPECT_THAT(FailureOf("a.uvxyz", "1 2 3\n"),
              AllOf(HasSubstr("u v x y z"), HasSubstr("first row has 3")));
  EXPECT_THAT(FailureOf("a.xyzl", "1 2 3\n"), HasSubstr("x y z label"));
}

TEST(TextReaderTest, TakesColoursFromTheColumnsAskedFor) {
  CloudReadOptions options;
  options.columns = {{"red", "4"}, {"green", "5"}, {"blue", "6"}};
  EXPECT_EQ(ReadBytes("a.xyz", "1 2 3 255 128 0\n", options).cloud.colours().col(0).cast<int>(),
            Eigen::Vector3i(255, 128, 0));
  options.columns.erase("blue");
  EXPECT_THAT(FailureOf("a.xyz", "1 2 3 255 128 0\n", options), HasSubstr("red, green and blue"));
}

TEST(TextReaderTest, ColoursCountToOneWhereNoneIsAboveAndOneIsNotWhole) {
  const auto colours = [](const std::string& text) -> Eigen::MatrixXi {
    return ReadBytes("a.xyzrgb", text).cloud.colours().cast<int>();
  };
  EXPECT_EQ(colours("1 2 3 0.5 0.5 1\n1 2 3 0 1 0.1\n"),
            (Eigen::MatrixXi(3, 2) << 128, 0, 128, 255, 255, 26).finished());
  EXPECT_EQ(colours("1 2 3 0 0 1\n1 2 3 1 1 0\n"),
            (Eigen::MatrixXi(3, 2) << 0, 1, 0, 1, 1, 0).finished());
  EXPECT_EQ(colours("1 2 3 0 0.5 1\n1 2 3 1 1 2\n"),
            (Eigen::MatrixXi(3, 2) << 0, 1, 1, 1, 1, 2).finished());
  EXPECT_EQ(colours("1 2 3 0 nan 1\n"), Eigen::Vector3i(0, 0, 1));
  // Whatever says so may come late.
  std::string text;
  for (int k = 0; k < 100'000; ++k) text += "1 2 3 0 1 1\n";
  EXPECT_EQ(colours(text).col(99'999), Eigen::Vector3i(0, 1, 1));
  EXPECT_EQ(colours(text + "1 2 3 0 0 0.5\n").col(0), Eigen::Vector3i(0, 255, 255));
  EXPECT_EQ(colours(text + "1 2 3 0 0 7\n").col(0), Eigen::Vector3i(0, 1, 1));
}

TEST(TextReaderTest, TwoColumnsAreAPlaneCloud) {
  const CloudFile file = ReadBytes("a.xy", "E387\n 1.0 0.5\n 0.25 -2\n");
  EXPECT_EQ(file.cloud.dimension(), 2);
  EXPECT_EQ(World(file.cloud).col(1), Eigen::Vector3d(0.25, -2, 0));
  EXPECT_THAT(FailureOf("a.xy", "1 2\n3 4 5\n"),
              AllOf(HasSubstr("line 2"), HasSubstr("2 columns")));
}

TEST(TextReaderTest, TakesTheColumnsAskedFor) {
  CloudReadOptions options;
  options.columns = {{"x", "4"}, {"y", "5"}, {"z", "2"}, {"u", "1"}, {"w", "3"}};
  const CloudFile file = ReadBytes("a.xyz", "0.5 3 7 1 2\n0.25 0.06 8 -4 5.5\n", options);
  EXPECT_EQ(World(file.cloud), TwoPoints());
  EXPECT_EQ(file.cloud.parameters().row(0), Eigen::RowVector2d(0.5, 0.25));
  EXPECT_EQ(file.cloud.parameters().row(1), Eigen::RowVector2d(0, 0));
  EXPECT_EQ(file.cloud.weights(), Eigen::Vector2d(7, 8));

  options.columns = {{"x", "b"}, {"y", "A"}};
  const CloudFile plane = ReadBytes("a.csv", "a,b,c\n2,1,9\n", options);
  EXPECT_EQ(plane.cloud.dimension(), 2);
  EXPECT_EQ(World(plane.cloud).col(0), Eigen::Vector3d(1, 2, 0));
}

TEST(TextReaderTest, RefusesColumnsThatAreNotThereNamingThoseThatAre) {
  const auto failure = [](std::map<std::string, std::string> columns,
                          std::vector<RowFilter> where = {}) {
    CloudReadOptions options;
    options.columns = std::move(columns);
    options.where = std::move(where);
    const TemporaryFolder folder;
    const std::string path = folder.With("a.csv", "east,north,label\n1,2,3\n");
    try {
      ReadCloud({path}, options);
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(failure({{"x", "4"}, {"y", "1"}}),
              AllOf(HasSubstr("'4'"), HasSubstr("east, north, label")));
  EXPECT_THAT(failure({{"x", "0"}, {"y", "1"}}), HasSubstr("'0'"));
  EXPECT_THAT(failure({{"x", "up"}, {"y", "1"}}), HasSubstr("'up'"));
  EXPECT_THAT(failure({{"x", "1"}}), HasSubstr("both x and y"));
  EXPECT_THAT(failure({{"nx", "1"}}), HasSubstr("nx, ny and nz"));
  EXPECT_THAT(failure({{"v", "1"}}), HasSubstr("column u"));
  EXPECT_THAT(failure({{"q", "1"}}), HasSubstr("unknown role 'q'"));
  EXPECT_THAT(failure({}, {{"class", 1}}), HasSubstr("'class'"));
}

TEST(TextReaderTest, DropsAndCountsRowsThatAreNotFinite) {
  const CloudFile file =
      ReadBytes("a.csv",
                "x,y,z,nx,ny,nz\n1,2,3,0,0,1\nnan,2,3,0,0,1\n1,-inf,3,0,0,1\n1,,3,0,0,1\n"
                "1,2,NaN,0,0,1\n-4,5.5,0.06,0,0,1\n");
  EXPECT_EQ(World(file.cloud), TwoPoints());
  EXPECT_EQ(file.non_finite, 4);
  EXPECT_EQ(file.points_in_file, 6);
}

TEST(TextReaderTest, KeepsPointsWhoseNormalIsMissingOrAbsurdWithNone) {
  for (const char* normal : {",,", "0,0,", "nan,0,1", "0,-inf,1", "0,0,1e19", "0,0,1e999"}) {
    const CloudFile file = ReadBytes(
        "a.csv", std::string("x,y,z,nx,ny,nz\n1,2,3,0,0.6,0.8\n-4,5.5,0.06,") + normal + "\n");
    EXPECT_EQ(World(file.cloud), TwoPoints()) << normal;
    EXPECT_EQ(file.non_finite, 0);
    EXPECT_EQ(file.cloud.normals().col(0), Eigen::Vector3d(0, 0.6, 0.8));
    EXPECT_EQ(file.cloud.normals().col(1), Eigen::Vector3d::Zero()) << normal;
  }
}

// A column that is also part of a normal keeps what it says about the place.
TEST(TextReaderTest, ANormalThatSharesAColumnWithThePlaceLeavesThePlaceAlone) {
  CloudReadOptions options;
  options.columns = {{"nx", "4"}, {"ny", "1"}, {"nz", "2"}};
  const CloudFile file = ReadBytes("a.xyz", "1 2 3 nan\n-4 5.5 .06 1\n", options);
  EXPECT_EQ(World(file.cloud), TwoPoints());
  EXPECT_EQ(file.cloud.normals().col(0), Eigen::Vector3d::Zero());
  EXPECT_EQ(file.cloud.normals().col(1), Eigen::Vector3d(1, -4, 5.5));
}

TEST(TextReaderTest, EveryMixtureOfLineEndsGivesTheSamePoints) {
  std::mt19937_64 random(kSeed);
  SCOPED_TRACE(kSeed);
  const std::array<std::string, 3> ends{"\n", "\r\n", "\r"};
  constexpr int kRows = 40'000;                      // more than a block of the reader
  for (std::size_t kinds = 1; kinds < 8; ++kinds) {  // a set of ends
    std::string text;
    for (int k = 0; k < kRows; ++k) {
      std::size_t kind = random() % 3;
      while ((kinds >> kind & 1) == 0) kind = (kind + 1) % 3;
      text += std::to_string(k) + " " + std::string(random() % 9, ' ') + "2 3 label" + ends[kind];
    }
    const CloudFile file = ReadBytes("a.xyz", text);
    ASSERT_EQ(file.points_in_file, kRows) << kinds;
    for (int k = 0; k < kRows; ++k) ASSERT_EQ(file.cloud.World(k), Eigen::Vector3d(k, 2, 3));
  }
}

TEST(TextReaderTest, NamesTheLineWhereLinesEndInReturnsOnly) {
  EXPECT_THAT(FailureOf("a.xyz", "x y z\r1 2 3\r\r4 5x 6\r"),
              AllOf(HasSubstr("line 4"), HasSubstr("'5x'")));
}

TEST(TextReaderTest, CommasAreDecimalWhereAnotherSeparatorLeavesAllRowsTheirColumns) {
  for (const char* rows : {"1;2;3\n-4;5,5;0,06\n",
                           "1,0 2,0 3,0\n-4,0 5,5 0,06\n",
                           "1,0\t2,0\t3,0\r\n-4,0\t5,5\t0,06\r\n",
                           "1,0; 2,0 ; 3;\n-4; 5,5; 6e-2;\n",
                           "\"1,0\";\"2\";\"3\"\n-4;\"5,5\";\"0,06\"\n",
                           "1,0 2 3 # a comment.\n-4 5,5 0,06\n",
                           "1 2 3\n-4 5,5 0,06\n"}) {
    for (const char* before : {"", "x;y;z\n", "# x y z\n", "A title, with commas\n"}) {
      const CloudFile file = ReadBytes("a.csv", std::string(before) + rows);
      EXPECT_EQ(World(file.cloud), TwoPoints()) << before << rows;
      EXPECT_THAT(file.remarks, ElementsAre(HasSubstr("decimal"))) << before << rows;
    }
  }
  EXPECT_EQ(ReadBytes("a.xy", "1,5;2,0\n-3,25;0,5\n").cloud.World(1),
            Eigen::Vector3d(-3.25, 0.5, 0));
  EXPECT_EQ(
      World(ReadBytes("a.csv", "Nr;X;Y;Z;Art\nP1;1,0;2,0;3;Ecke,links\nP2;-4;5,5;0,06;\n").cloud),
      TwoPoints());
}

TEST(TextReaderTest, RefusesCommasThatMayBeDecimalInSomeRowsOnly) {
  EXPECT_THAT(FailureOf("a.csv", "1,5;2;3\n4,5;5,6,7;8\n"),
              AllOf(HasSubstr("line 2"),
                    HasSubstr("decimal from line 1 on"),
                    HasSubstr("'4,5;5,6,7;8'"),
                    HasSubstr("write decimal points")));
  EXPECT_THAT(FailureOf("a.xyz", "1,2 3,4 5\n1,2 3.5,4 5\n"), HasSubstr("line 2"));
  EXPECT_THAT(FailureOf("a.xyz", "1 2 3\n1,2 3\n"),
              AllOf(HasSubstr("line 2"), HasSubstr("may be decimal or separators")));
}

TEST(TextReaderTest, CommasThatOnlySeparateAreStillSeparators) {
  for (const char* text : {"1,2,3\n-4,5.5,.06\n",
                           "1, 2, 3\n-4, 5.5, .06\n",
                           "1 ,2 ,3\n-4 ,5.5 ,.06\n",
                           "1,2,3,\n-4,5.5,.06,\n",
                           "1,2,3 # 1,5 2,5\n-4,5.5,.06\n",
                           "1 2 3 # 1,5 2,5\n-4 5.5 .06 # a,b\n",
                           "1,2,3 wall,floor\n-4,5.5,.06 wall\n",
                           "1;2;3;a,b\n-4;5.5;.06;1,2\n"}) {
    const CloudFile file = ReadBytes("a.csv", text);
    EXPECT_EQ(World(file.cloud), TwoPoints()) << text;
    EXPECT_THAT(file.remarks, ::testing::IsEmpty()) << text;
  }
  EXPECT_EQ(ReadBytes("a.csv", "1,5,2,0\n3,5,4,0\n").cloud.World(1), Eigen::Vector3d(3, 5, 4));
  EXPECT_EQ(ReadBytes("a.xy", "52,407\n8,846\n").cloud.World(0), Eigen::Vector3d(52, 407, 0));
}

TEST(TextReaderTest, AHeaderThatNamesFewerColumnsThanTheRowHasIsRefused) {
  for (const char* text : {"x,y,z\n1,2,3,4\n",
                           "x y z\n0 1 2 3\n",
                           "y\tx\n1\t2\t3\n",
                           "z,x\n1,2,3\n",
                           "northing,easting,height\n7,1,2,3\n"}) {
    EXPECT_THAT(FailureOf("a.csv", text),
                AllOf(HasSubstr("line 1"), HasSubstr("header names"), HasSubstr("--columns")))
        << text;
  }
  EXPECT_THAT(FailureOf("a.csv", "x,y,z\n1,2,3,4\n"),
              AllOf(HasSubstr("names 3 columns"), HasSubstr("has 4 fields")));
  CloudReadOptions options;
  options.columns = {{"x", "1"}, {"y", "2"}, {"z", "3"}};
  EXPECT_EQ(World(ReadBytes("a.csv", "x,y,z\n1,2,3,4\n-4,5.5,.06,4\n", options).cloud),
            TwoPoints());
  for (const char* text : {"x,y,z\n1,2,3,\n-4,5.5,.06,\n",
                           "x,y,z,\n1,2,3,\n-4,5.5,.06,\n",
                           "x;y;z\n1;2;3;;\n-4;5.5;.06;;\n",
                           "// x y z and more words\n1 2 3 4\n-4 5.5 .06 7\n",
                           "# x y z\n1 2 3 4\n-4 5.5 .06 7\n"}) {
    EXPECT_EQ(World(ReadBytes("a.csv", text).cloud), TwoPoints()) << text;
  }
}

// A blank may stand inside a name, and an empty cell between tabs leaves no trace.
TEST(TextReaderTest, AHeaderWithMoreNamesIsRefusedWhereTheyMayHaveShifted) {
  EXPECT_THAT(FailureOf("a.txt", "Point ID X Y Z R\n7 1 2 3 9\n"),
              AllOf(HasSubstr("names 6 columns"), HasSubstr("has 5 fields")));
  EXPECT_THAT(FailureOf("a.txt", "id\tname\tx\ty\tz\tq\n7\t\t1\t2\t3\t9\n"),
              HasSubstr("names 6 columns"));
  for (const char* text : {"x,y,z,comment\n1,2,3\n-4,5.5,.06,wall\n",
                           "id,x,y,z,comment\n7,1,2,3\n7,-4,5.5,.06\n",
                           "x y z Scan Angle\n1 2 3 7\n-4 5.5 .06 8\n"}) {
    EXPECT_EQ(World(ReadBytes("a.txt", text).cloud), TwoPoints()) << text;
  }
}

TEST(TextReaderTest, NamesThatLackXOrYAreNotPassedOver) {
  EXPECT_THAT(FailureOf("a.csv", "z,x\n1,2\n"),
              AllOf(HasSubstr("name x and z but not y"), HasSubstr("columns are z, x")));
  EXPECT_THAT(FailureOf("a.csv", "x,z\n1,2\n"), HasSubstr("name x and z but not y"));
  EXPECT_THAT(FailureOf("a.csv", "t,y,q\n1,2,3\n").empty(), true);
  EXPECT_THAT(FailureOf("a.csv", "y,t,q\n1,2,3\n"), HasSubstr("name y but not x"));
  EXPECT_THAT(FailureOf("a.csv", "time,breadth,length,height\n1,2,3,4\n"),
              HasSubstr("name z but not x and y"));
  const Eigen::Vector3d swapped = ReadBytes("a.csv", "y,x\n1,2\n").cloud.World(0);
  EXPECT_EQ(swapped, Eigen::Vector3d(2, 1, 0));
  EXPECT_EQ(World(ReadBytes("a.csv", "east,north,height\n1,2,3\n-4,5.5,.06\n").cloud), TwoPoints());
  EXPECT_EQ(World(ReadBytes("a.csv", ",x,y,z\n0,1,2,3\n1,-4,5.5,.06\n").cloud), TwoPoints());
}

TEST(TextReaderTest, ADamagedFirstRowIsNoHeader) {
  for (const char* row : {"0x10 2 3", "1\"2 3", "-52.4D+00 1 2", "l0 2 3", "N/A,2,3", "1,5x;2;3"}) {
    for (const char* after : {"", "1 2 3\n4 5 6\n"}) {
      const std::string failure =
          FailureOf("a.xyz", std::string("# first\n").append(row).append("\n").append(after));
      EXPECT_THAT(failure, AllOf(HasSubstr("line 2"), HasSubstr("expected a number"))) << row;
    }
  }
}

TEST(TextReaderTest, TitlesMayHoldNumbers) {
  for (const char* title :
       {"E387", "NACA 0012", "3D scan 7", "Scan 5 of 10 on day 3", "2024-05-01"}) {
    EXPECT_EQ(World(ReadBytes("a.txt", std::string(title) + "\n1 2 3\n-4 5.5 .06\n").cloud),
              TwoPoints())
        << title;
    EXPECT_EQ(ReadBytes("a.dat", std::string(title) + "\n1 2\n3 4\n").cloud.size(), 2) << title;
  }
}

// Two blocks of a profile's sides, from the nose each, as a text of the separator and line end.
std::string TwoSides(const std::string& between, const std::string& end) {
  std::string text;
  for (const char* side : {"", "-"}) {
    if (*side != '\0') text += end;
    for (const char* row : {"0.0 0.0", "0.25 0.05", "1. .001"}) {
      const std::string xy = row;
      const std::size_t blank = xy.find(' ');
      text += xy.substr(0, blank) + between + side + xy.substr(blank + 1) + end;
    }
  }
  return text;
}

// The heads of the files of Selig, Lednicer, the UIUC, XFOIL and OpenVSP, and keys with values.
TEST(TextReaderTest, NoLineBeforeTheRowsIsAPoint) {
  for (const char* head : {"",
                           "NACA 2412\n",
                           "CLARK Y AIRFOIL 11.7%\n",
                           "  23012 modified (0.12) 5\n",
                           "NACA 64 210\n",
                           " SOME AIRFOIL\n       3.       3.\n\n",
                           "SOME AIRFOIL\n3 3\n",
                           "3.0, 3.0\n\n",
                           "E 387\n6\n",
                           "NumCoords 6\n",
                           "N = 6\n",
                           "6\tNumPnts\n",
                           "name: wing 7\norigin: 12 30\ncount: 6\nunits: m\n\n",
                           "DEMO GEOM AIRFOIL FILE\nNACA 0012\n0\tSym Flag (0 - No, 1 - Yes)\n"
                           "3\tNum Pnts Upper\n3\tNum Pnts Lower\n",
                           "T1208 GEOM AIRFOIL FILE\nNACA 63A012\n0\n3\n3\n",
                           "OPENVSP_XSEC_FILE_V1\n",
                           "FUSE XSEC FILE\t\nBox\t\n6\tNumPnts\n"}) {
    for (const char* between : {" ", "\t", "  ", ","}) {
      for (const char* end : {"\n", "\r\n", "\r"}) {
        std::string text = *head == '\0' ? "" : "\xEF\xBB\xBF";
        for (const char* c = head; *c != '\0'; ++c) text += *c == '\n' ? end : std::string(1, *c);
        const CloudFile file = ReadBytes("a.dat", text + TwoSides(between, end));
        SCOPED_TRACE(text);
        ASSERT_EQ(file.cloud.size(), 6);
        EXPECT_EQ(file.cloud.dimension(), 2);
        EXPECT_EQ(file.cloud.World(0), Eigen::Vector3d(0, 0, 0));
        EXPECT_EQ(file.cloud.World(5), Eigen::Vector3d(1, -0.001, 0));
        EXPECT_THAT(file.blocks, ElementsAre(0, 3));
        EXPECT_THAT(file.fields, ElementsAre(::testing::_, ::testing::_));
      }
    }
  }
}

TEST(TextReaderTest, WholeNumbersThatCountNothingAreAPoint) {
  EXPECT_EQ(ReadBytes("a.xy", "3 3\n1 2\n2 3\n3 4\n4 5\n5 6\n6 7\n").cloud.size(), 7);
  EXPECT_EQ(ReadBytes("a.xy", "4 3\n\n1 2\n2 3\n3 4\n\n4 5\n5 6\n6 7\n").cloud.size(), 7);
  EXPECT_EQ(ReadBytes("a.xy", "2 3\n1 2\n2 3\n\n3 4\n4 5\n").cloud.size(), 5);
  EXPECT_EQ(ReadBytes("a.xyz", "0 3 3\n\n1 2 3\n4 5 6\n").cloud.size(), 3);
  std::string large;  // beyond 64 bits by its sum
  for (int k = 0; k < 12; ++k) large += "900000000000000000 ";
  EXPECT_EQ(ReadBytes("a.xyz", large + "\n\n1 2 3\n").cloud.size(), 2);
}

TEST(TextReaderTest, ACommentHasNoCommas) {
  const Eigen::Matrix3Xd expected =
      (Eigen::Matrix3Xd(3, 3) << 1, 8.648, 4.5, 2, 8.583, 5.5, 3, 1.452, 6.5).finished();
  for (const char* text : {"1 2 3 # first, point\n8,648 8,583 1,452\n4,5 5,5 6,5\n",
                           "1 2 3\n8,648 8,583 1,452 // a, b\n4,5 5,5 6,5\n",
                           "# x, y, z\n1 2 3\n8,648 8,583 1,452\n4,5 5,5 6,5 # last, point\n"}) {
    const CloudFile file = ReadBytes("a.txt", text);
    EXPECT_EQ(World(file.cloud), expected) << text;
    EXPECT_THAT(file.remarks, ElementsAre(HasSubstr("are decimal"))) << text;
  }
  // In rows of other commas too.
  EXPECT_EQ(ReadBytes("a.txt", "1,5 2,5 3,5\n4 5 6 # last, point\n").cloud.World(1),
            Eigen::Vector3d(4, 5, 6));
  EXPECT_THAT(ReadBytes("a.txt", "1 2 3 # a, b\n4 5 6\n").remarks, ::testing::IsEmpty());
}

TEST(TextReaderTest, SignsBetweenThousandsAreRefused) {
  for (const char* text : {"1.234,56 2.345,67 3,5\n",
                           "950,25 1.234,56\n",
                           "-1.234.567,8;+2.345,6\n",
                           "1 2 3\n1.234,56 2.345,67 3\n",
                           "1,5 2,5\n1.234,56\t2.345,67 # far\n",
                           "1,234.56 2,345.67 3.5\n"}) {
    EXPECT_THAT(FailureOf("a.txt", text),
                AllOf(HasSubstr("line "), HasSubstr("thousands"), HasSubstr("1234.56")))
        << text;
  }
  for (const char* text : {"1.234,56\n2.345,67\n",            // two columns
                           "1.234,56 , 2.345\n1,2,3\n",       // three
                           "1.5,2.5 3.5\n1.5,2.5 3.5\n",      // mixed, yet plain
                           "1.2345,56 2.3456,67\n1,2,3,4\n",  // no groups of three
                           "1.234, 56, 2.345, 67\n1,2,3,4\n"}) {
    EXPECT_GT(ReadBytes("a.txt", text).cloud.size(), 0) << text;
  }
}

TEST(TextReaderTest, TitlesThatMayBePointsAreTold) {
  for (const char* head : {"null 2 1\nnull 3 1\n",
                           "one 2.0 1.0\n",
                           "abc 2.0 1.0\nabd 3 1\n",
                           "Survey of\ncorner_0 2.0 0\ncorner_1 2.0 1\n",
                           "measured 2024 11 29\n"}) {
    const CloudFile file = ReadBytes("a.txt", std::string(head) + "1 2.5 3\n4 5.5 6\n7 8 9.5\n");
    EXPECT_EQ(file.cloud.size(), 3) << head;
    EXPECT_THAT(file.remarks, ElementsAre(AllOf(HasSubstr("line"), HasSubstr("taken for"))))
        << head;
  }
  EXPECT_THAT(ReadBytes("a.txt", "one 2 1\ntwo 3 1\nsix 3 1\n1 2.5 3\n4 5.5 6\n").remarks,
              ElementsAre(HasSubstr("lines 1 to 3 are taken for titles")));
  EXPECT_THAT(ReadBytes("a.txt", "one 2.5\n1 2.5\n4 5.5\n").remarks,
              ElementsAre(HasSubstr("line 1 is taken for a title")));
  for (const char* plain : {"A plain title\n1 2 3\n4 5 6\n",
                            "A title of some words\n1 2 3\n",
                            "Survey 7\n1 2 3\n",
                            "x,y,z\n1,2,3\n",
                            "2\n1 2 3\n4 5 6\n",
                            "NACA 2412\n1 0.5\n0 0\n"}) {
    EXPECT_THAT(ReadBytes("a.txt", plain).remarks, ::testing::IsEmpty()) << plain;
  }
}

TEST(TextReaderTest, CountsInTheFormOfAPointAreTold) {
  EXPECT_THAT(ReadBytes("a.dat", "4 3\n0 0\n1 2\n2 3\n3 4\n\n5 6\n6 7\n7 8\n").remarks,
              ElementsAre(AllOf(HasSubstr("line 1 counts the rows"), HasSubstr("'4 3'"))));
  EXPECT_THAT(
      ReadBytes("a.xyz", "A wing\n2 2 1\n\n1 2 3\n4 5 6\n\n1 2 3\n4 5 6\n\n7 8 9\n").remarks,
      ElementsAre(HasSubstr("line 2 counts the rows")));
  EXPECT_THAT(ReadBytes("a.xyz", "2 2\n\n1 2 3\n4 5 6\n\n1 2 3\n4 5 6\n").remarks,
              ::testing::IsEmpty());
}

// Never a point less without a word.
TEST(TextReaderTest, PointsOfThePlaneWithTextBehindThemAreRefused) {
  for (const char* text : {"A title\n0 0 tail\n1 1 nose of it\n2 2\n",
                           "0 0 tail of it\n1 1\n2 2\n",
                           "2412 15 NACA wing\n1 0\n0 0\n"}) {
    EXPECT_THAT(FailureOf("a.dat", text), HasSubstr("expected a number, found '")) << text;
  }
  EXPECT_THAT(FailureOf("a.dat", "A title\n0 0\n1 1 nose\n"),
              AllOf(HasSubstr("line 3"), HasSubstr("2 columns")));
}

TEST(TextReaderTest, AFileThatEndsBeforeItsCountsIsRefused) {
  EXPECT_THAT(FailureOf("a.dat", "A PROFILE\n3. 3.\n\n0 0\n.5 .1\n1 0\n\n0 0\n.5 -.1\n"),
              AllOf(HasSubstr("5 of the 6 points"), HasSubstr("line 9")));
}

TEST(TextReaderTest, BlocksBeginAfterLinesOfBlanks) {
  CloudReadOptions upper;
  upper.where = {{"4", 1}};
  const char* const text =
      "1 2 3 1\n\n \t\n4 5 6 0\n\n# a comment\n7 8 9 1\n# another\n1 1 1 1\n\n";
  EXPECT_THAT(ReadBytes("a.xyz", text).blocks, ElementsAre(0, 1, 2));
  EXPECT_THAT(ReadBytes("a.xyz", text, upper).blocks, ElementsAre(0, 1));
  EXPECT_THAT(ReadBytes("a.xyz", "1 2 nan\n\n1 2 3\n2 3 4\n\nnan 1 1\n\n1 1 1\n").blocks,
              ElementsAre(0, 2));
  const TemporaryFolder folder;
  const std::vector<std::string> paths{folder.With("a.xyz", "1 2 3\n\n4 5 6\n"),
                                       folder.With("b.obj", "v 1 2 3\nv 3 4 5\n"),
                                       folder.With("c.xyz", "1 2 3\n")};
  EXPECT_THAT(ReadCloud(paths).blocks, ElementsAre(0, 1, 2, 4));
  // Across the reader's batches.
  std::string rows;
  for (int k = 0; k < 5000; ++k)
    rows += std::to_string(k) + (k % 1500 == 0 ? " 2 3\n\n" : " 2 3\n");
  EXPECT_THAT(ReadBytes("a.xyz", rows).blocks, ElementsAre(0, 1, 1501, 3001, 4501));
}

TEST(TextReaderTest, KnowsTheUsualNamesOfPlacesInAnyCase) {
  CloudReadOptions stay;
  stay.projection = CloudProjection::kNone;
  for (const char* names :
       {"Z,X,Y", "Height,Easting,northing", "ELEVATION,LON,Lat", "alt,Longitude,LATITUDE"}) {
    const CloudFile file = ReadBytes("a.csv", std::string(names) + "\n3,1,2\n0.06,-4,5.5\n", stay);
    EXPECT_EQ(World(file.cloud), TwoPoints()) << names;
    EXPECT_THAT(file.remarks, ::testing::IsEmpty());
  }
}

TEST(TextReaderTest, RowsMayBeginWithAName) {
  CloudReadOptions options;
  options.columns = {{"x", "2"}, {"y", "3"}, {"z", "4"}};
  for (const char* text : {"P1 1 2 3\nP2 -4 5.5 .06\n",
                           "12:30:01,1,2,3\n12:30:02,-4,5.5,.06\n",
                           "name,a,b,c\nP1,1,2,3\nP2,-4,5.5,.06\n"}) {
    EXPECT_EQ(World(ReadBytes("a.txt", text, options).cloud), TwoPoints()) << text;
  }
  EXPECT_THAT(FailureOf("a.txt", "P1 1.0x 2 3\nP2 4 5 6\n", options),
              AllOf(HasSubstr("line 1"), HasSubstr("'1.0x'")));
  EXPECT_THAT(FailureOf("a.txt", "P1 1 2 3\nP2 4 5 6\n"),
              AllOf(HasSubstr("line 1"), HasSubstr("'P1'")));
}

TEST(TextReaderTest, QuotesWhatIsNoNumberWithItsLine) {
  EXPECT_THAT(FailureOf("a.xyz", "1 2 3\n\n4 5x 6\n"),
              AllOf(HasSubstr("line 3"), HasSubstr("'5x'")));
  EXPECT_THAT(FailureOf("a.xyz", "1 2 3\n4 +-5 6\n"), HasSubstr("'+-5'"));
  EXPECT_THAT(FailureOf("a.xyz", "1 2 3\n4 5/6 6\n"), HasSubstr("'5/6'"));
  EXPECT_THAT(FailureOf("a.xyz", "1 2 3\n4 5\n"), AllOf(HasSubstr("line 2"), HasSubstr("found 2")));
  EXPECT_THAT(FailureOf("a.xyz", "1 2 3\n\x01\x02 5 6\n"), HasSubstr("'\\x01\\x02'"));
  EXPECT_THAT(FailureOf("a.xyz", "1\n2\n3\n"), HasSubstr("one column"));
  const std::string failure = FailureOf("a.xyz", "1 2 3\n" + std::string(5000, 'q') + " 5 6\n");
  EXPECT_LT(failure.size(), 200u);
  EXPECT_THAT(failure, Not(HasSubstr("\n")));
}

TEST(TextReaderTest, RefusesNumbersTooLargeToCalculateWith) {
  EXPECT_THAT(FailureOf("a.xyz", "1 2 3\n4 1e308 6\n"),
              AllOf(HasSubstr("line 2"), HasSubstr("1e+308")));
  EXPECT_THAT(FailureOf("a.xyz", "1 2 3\n4 -1e999 6\n"), HasSubstr("line 2"));
  EXPECT_EQ(ReadBytes("a.xyz", "1 2 1e-999\n").cloud.World(0), Eigen::Vector3d(1, 2, 0));
}

TEST(TextReaderTest, RefusesWeightsThatAreNotPositive) {
  EXPECT_THAT(FailureOf("a.csv", "x,y,z,w\n1,2,3,1\n1,2,3,0\n"),
              AllOf(HasSubstr("line 3"), HasSubstr("weight 0")));
}

TEST(TextReaderTest, StopsEarlyInGarbage) {
  EXPECT_THAT(FailureOf("a.xyz", std::string(1 << 22, 'a')), HasSubstr("longer than"));
  EXPECT_THAT(FailureOf("a.xyz", std::string(1 << 22, '\0')), HasSubstr("line 1"));
  EXPECT_THAT(FailureOf("a.xyz", "1 2 3\n" + std::string(1 << 22, ' ')), HasSubstr("line 2"));
  EXPECT_THAT(FailureOf("a.xyz", std::string("\xFF\xFE") + "1"), HasSubstr("UTF-16"));
  EXPECT_NE(FailureOf("a.xyz",
                      std::string("\x7F"
                                  "ELF\x02\x01\n\0\0\x13\n",
                                  12)),
            "");
}

TEST(TextReaderTest, HoldsAPtsCountAgainstItsRows) {
  EXPECT_EQ(ReadBytes("a.pts", "2\n1 2 3\n-4 5.5 0.06\n").cloud.size(), 2);
  EXPECT_THAT(FailureOf("a.pts", "1000000000\n1 2 3\n"),
              AllOf(HasSubstr("1 of the 1000000000 points"), HasSubstr("remove that line")));
}

// Numbers across the border of the reader's blocks are whole.
TEST(TextReaderTest, ReadsFilesOfManyBlocks) {
  std::string text;
  constexpr int kRows = 200'000;
  for (int k = 0; k < kRows; ++k) {
    text +=
        std::to_string(k) + " " + std::to_string(k % 1013) + " " + std::string(k % 37, ' ') + "7\n";
  }
  const PointCloud cloud = ReadBytes("a.xyz", text).cloud;
  ASSERT_EQ(cloud.size(), kRows);
  for (int k = 0; k < kRows; ++k) ASSERT_EQ(cloud.World(k), Eigen::Vector3d(k, k % 1013, 7));
}

}  // namespace batten::internal::text_reader_test
