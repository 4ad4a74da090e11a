// SPDX-License-Identifier: MIT
#include "io/cloud/stl_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "io/cloud/distinct_points.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cloud_bytes.h"

namespace batten::internal::stl_reader_test {

using ::testing::AllOf;
using ::testing::HasSubstr;

using Corner = std::array<float, 3>;
using Facets = std::vector<std::array<Corner, 3>>;

std::string BinaryStl(const Facets& facets, const std::string& comment = "made by a test") {
  std::string bytes = comment + std::string(80 - comment.size(), '\0');
  bytes += LittleEndian(static_cast<std::uint32_t>(facets.size()));
  for (const auto& facet : facets) {
    for (int d = 0; d < 3; ++d) bytes += LittleEndian(0.5f);  // the normal
    for (const Corner& corner : facet) {
      for (const float x : corner) bytes += LittleEndian(x);
    }
    bytes += LittleEndian(std::uint16_t{7});
  }
  return bytes;
}

std::string AsciiStl(const Facets& facets) {
  std::string text = "solid made by a test\n";
  char line[100];
  for (const auto& facet : facets) {
    text += "  facet normal 0.5 0.5 0.5\n    outer loop\n";
    for (const Corner& c : facet) {
      std::snprintf(line, sizeof line, "      vertex %.9g %.9g %.9g\n", c[0], c[1], c[2]);
      text += line;
    }
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid made by a test\n";
}

// A bumpy sheet of n × n vertices in 2 (n − 1)² facets, in random order.
Facets Sheet(int n, std::mt19937_64& random) {
  std::vector<Corner> vertices;
  // Of few digits: the decimal numbers of the text are then exactly the floats.
  const auto height = [&] { return static_cast<float>(random() % 512) / 256 - 1; };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      vertices.push_back({static_cast<float>(i), static_cast<float>(j), height()});
    }
  }
  Facets facets;
  for (int i = 0; i + 1 < n; ++i) {
    for (int j = 0; j + 1 < n; ++j) {
      const auto at = [&](int a, int b) { return vertices[static_cast<std::size_t>(a * n + b)]; };
      facets.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      facets.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  std::shuffle(facets.begin(), facets.end(), random);
  return facets;
}

// The distinct corners in the order in which they first appear, found by an ordered map.
Eigen::Matrix3Xd DistinctCorners(const Facets& facets) {
  std::map<Corner, int> seen;
  std::vector<Corner> order;
  for (const auto& facet : facets) {
    for (const Corner& corner : facet) {
      if (seen.emplace(corner, 0).second) order.push_back(corner);
    }
  }
  Eigen::Matrix3Xd points(3, order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    for (int d = 0; d < 3; ++d) {
      points(d, static_cast<Eigen::Index>(k)) =
          static_cast<double>(order[k][static_cast<std::size_t>(d)]);
    }
  }
  return points;
}

TEST(StlReaderTest, HoldsEveryVertexOnceInBothForms) {
  std::mt19937_64 random(9);
  for (const int n : {2, 5, 300}) {
    const Facets facets = Sheet(n, random);
    const Eigen::Matrix3Xd expected = DistinctCorners(facets);
    ASSERT_EQ(expected.cols(), n * n);
    for (const std::string& bytes : {BinaryStl(facets),
                                     AsciiStl(facets),
                                     BinaryStl(facets, "solid in name only"),
                                     BinaryStl(facets) + "trailing bytes"}) {
      const CloudFile file = ReadBytes("a.stl", bytes);
      EXPECT_TRUE(World(file.cloud) == expected) << n;
      EXPECT_EQ(file.points_in_file, n * n);
    }
  }
}

TEST(StlReaderTest, MergesExactlyEqualCornersOnly) {
  const float next = std::nextafter(1.0f, 2.0f);
  const Facets facets{{Corner{0.0f, 1, 2}, Corner{-0.0f, 1, 2}, Corner{0, next, 2}}};
  EXPECT_EQ(ReadBytes("a.stl", BinaryStl(facets)).cloud.size(), 2);
  EXPECT_EQ(ReadBytes("a.stl", AsciiStl(facets)).cloud.size(), 2);
}

TEST(StlReaderTest, CountsDistinctCornersThatAreNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Corner a{1, 2, 3}, b{nan, 0, 0}, c{0, std::numeric_limits<float>::infinity(), 0};
  const CloudFile file = ReadBytes("a.stl", BinaryStl({{a, b, c}, {a, b, c}}));
  EXPECT_EQ(file.cloud.size(), 1);
  EXPECT_EQ(file.non_finite, 2);
  EXPECT_EQ(file.points_in_file, 3);
}

TEST(StlReaderTest, ReadsAnyCaseBlanksAndSeveralSolids) {
  const CloudFile file =
      ReadBytes("a.stl",
                "SOLID a\r\n FACET NORMAL 0 0 1\r\n\tOUTER LOOP\r\n\tVERTEX\t1 2 3\r\n"
                "VERTEX -4 5.5e0 .06\r\nvertex 0 0 0\r\nENDLOOP\r\nENDFACET\r\nENDSOLID a\r\n\r\n"
                "solid\nfacet normal 0 0 1\nouter loop\nvertex 1 2 3\nvertex 7 8 9\n"
                "vertex 0 0 0\nendloop\nendfacet\nendsolid\n");
  EXPECT_EQ(World(file.cloud),
            (Eigen::Matrix3Xd(3, 4) << 1, -4, 0, 7, 2, 5.5, 0, 8, 3, .06, 0, 9).finished());
}

TEST(StlReaderTest, RefusesDamagedTextByLine) {
  const std::string start = "solid a\nfacet normal 0 0 1\nouter loop\n";
  EXPECT_THAT(FailureOf("a.stl", start + "vertex 1 2\n"),
              AllOf(HasSubstr("line 4"), HasSubstr("three numbers")));
  EXPECT_THAT(FailureOf("a.stl", start + "vertex 1 2 x\n"), HasSubstr("line 4"));
  EXPECT_THAT(FailureOf("a.stl", start + "vertex 1 2 3\nendloop\nendfacet\nendsolid\n"),
              AllOf(HasSubstr("line 6"), HasSubstr("not 1")));
  EXPECT_THAT(FailureOf("a.stl", start + "corner 1 2 3\n"), HasSubstr("'corner 1 2 3'"));
  EXPECT_THAT(FailureOf("a.stl", start + "vertex 1 2 3\n"), HasSubstr("before endsolid"));
  EXPECT_THAT(FailureOf("a.stl",
                        start + "vertex 1 2 1e300\nvertex 0 0 0\nvertex 1 1 1\nendloop\n"
                                "endfacet\nendsolid\n"),
              AllOf(HasSubstr("vertex 1"), HasSubstr("1e+300")));
  EXPECT_THAT(FailureOf("a.stl", "solid a\nendsolid a\n"), HasSubstr("no usable point"));
  EXPECT_THAT(FailureOf("a.stl", "hello"), HasSubstr("no STL file"));
}

TEST(StlReaderTest, RefusesCountsThatTheFileIsTooShortFor) {
  std::mt19937_64 random(9);
  std::string bytes = BinaryStl(Sheet(2, random));
  for (const std::uint32_t count : {3u, 1'000'000u, 4'294'967'295u}) {
    bytes.replace(80, 4, LittleEndian(count));
    EXPECT_THAT(FailureOf("a.stl", bytes),
                AllOf(HasSubstr("byte 84"), HasSubstr("promises " + std::to_string(count))));
  }
}

TEST(StlReaderTest, RefusesEveryTruncation) {
  std::mt19937_64 random(9);
  const Facets facets = Sheet(2, random);
  const std::string binary = BinaryStl(facets), ascii = AsciiStl(facets);
  for (std::size_t size = 0; size < binary.size(); ++size) {
    EXPECT_NE(FailureOf("a.stl", std::string_view(binary).substr(0, size)), "") << size;
  }
  const std::size_t last_word = ascii.rfind("endsolid") + 8;
  for (std::size_t size = 0; size < last_word; ++size) {
    EXPECT_NE(FailureOf("a.stl", std::string_view(ascii).substr(0, size)), "") << size;
  }
}

TEST(DistinctPointsTest, KeepsFirstAppearancesWhateverItExpects) {
  std::mt19937_64 random(10);
  for (const std::int64_t expected :
       {std::int64_t{0}, std::int64_t{100}, std::int64_t{1'000'000}}) {
    DistinctPoints<double> points(expected);
    std::map<std::array<double, 3>, int> seen;
    std::vector<std::array<double, 3>> order;
    for (int k = 0; k < 200'000; ++k) {
      const std::array<double, 3> point{static_cast<double>(random() % 50),
                                        static_cast<double>(random() % 50),
                                        static_cast<double>(random() % 50)};
      if (seen.emplace(point, 0).second) order.push_back(point);
      points.Add(point);
    }
    points.Close();
    ASSERT_EQ(points.size(), static_cast<std::int64_t>(order.size()));
    for (std::int64_t k = 0; k < points.size(); ++k) {
      ASSERT_EQ(points[k], order[static_cast<std::size_t>(k)]);
    }
  }
}

}  // namespace batten::internal::stl_reader_test
