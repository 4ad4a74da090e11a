// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <string_view>

#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cloud_bytes.h"

namespace batten::internal::ply_reader_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr unsigned kSeed = 3;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// One vertex: a list comes before it, its properties have all sizes.
template <class Bytes>
std::string MixedPly(std::string_view format, Bytes bytes) {
  std::string text =
      "ply\r\nformat " + std::string(format) +
      " 1.0\r\nobj_info x\r\nelement camera 2\r\nproperty float32 f\r\nproperty uchar c\r\n"
      "element strip 2\r\nproperty list uint16 int32 indices\r\nproperty char q\r\n"
      "element vertex 1\r\nproperty uint8 red\r\nproperty int16 z\r\nproperty uchar green\r\n"
      "property float64 x\r\nproperty uchar blue\r\nproperty float y\r\nproperty float nx\r\n"
      "property float ny\r\nproperty float nz\r\nproperty uint label\r\n"
      "element face 1\r\nproperty list uchar int vertex_indices\r\nend_header\r\n";
  for (int k = 0; k < 2; ++k) text += bytes(1.5f) + bytes(std::uint8_t{3});
  text += bytes(std::uint16_t{3}) + bytes(1) + bytes(2) + bytes(3) + bytes(std::int8_t{-1});
  text += bytes(std::uint16_t{0}) + bytes(std::int8_t{-1});
  text += bytes(std::uint8_t{200}) + bytes(std::int16_t{-300}) + bytes(std::uint8_t{100}) +
          bytes(5400000.123456789) + bytes(std::uint8_t{50}) + bytes(2.5f) + bytes(0.0f) +
          bytes(0.0f) + bytes(1.0f) + bytes(std::uint32_t{4000000000});
  return text + bytes(std::uint8_t{1}) + bytes(0);
}

void ExpectMixed(const CloudFile& file) {
  ASSERT_EQ(file.cloud.size(), 1);
  EXPECT_EQ(file.cloud.World(0), Eigen::Vector3d(5400000.123456789, 2.5, -300));
  EXPECT_EQ(file.cloud.normals().col(0), Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(file.cloud.colours().col(0).cast<int>(), Eigen::Vector3i(200, 100, 50));
  EXPECT_THAT(file.fields,
              ElementsAre("red", "z", "green", "x", "blue", "y", "nx", "ny", "nz", "label"));
}

TEST(PlyReaderTest, ReadsAnyTypesInBothByteOrdersBehindOtherElements) {
  CloudReadOptions options;
  options.where = {{"label", 4e9}};
  ExpectMixed(ReadBytes(
      "a.ply", MixedPly("binary_little_endian", [](auto v) { return LittleEndian(v); }), options));
  ExpectMixed(ReadBytes(
      "a.ply", MixedPly("binary_big_endian", [](auto v) { return BigEndian(v); }), options));
}

TEST(PlyReaderTest, ReadsAscii) {
  const CloudFile file =
      ReadBytes("a.ply",
                "ply\nformat ascii 1.0\nelement strip 2\nproperty list uchar int i\n"
                "element vertex 2\nproperty float x\nproperty float y\n"
                "property float red\nproperty float green\nproperty float blue\n"
                "property double z\nend_header\n3 1 2 3\n0\n"
                "1 2 1 0.5 0 3\n-4 5.5 0 0 0 0.06\n");
  EXPECT_EQ(file.cloud.World(1), Eigen::Vector3d(-4, 5.5, 0.06));
  EXPECT_EQ(file.cloud.colours().col(0).cast<int>(), Eigen::Vector3i(255, 128, 0));
}

// Vertices 0 … count − 1 at (k, 2k, 3k), each between two lists of any length.
template <class Bytes>
std::string ListedPly(std::string_view format, int count, Bytes bytes) {
  std::mt19937_64 random(kSeed);
  std::string text = PlyHeader(format,
                               count,
                               "property list uchar int before\nproperty double x\n"
                               "property float y\nproperty list uint16 double between\n"
                               "property uchar q\nproperty int z\n");
  for (int k = 0; k < count; ++k) {
    const auto before = static_cast<std::uint8_t>(random() % 4);
    const auto between = static_cast<std::uint16_t>(k % 100 == 7 ? 400 : random() % 3);
    text += bytes(before);
    for (int n = 0; n < before; ++n) text += bytes(n);
    text += bytes(1.0 * k) + bytes(2.0f * static_cast<float>(k)) + bytes(between);
    for (int n = 0; n < between; ++n) text += bytes(0.5 * n);
    text += bytes(static_cast<std::uint8_t>(k % 2)) + bytes(3 * k);
    if (format == "ascii") text += "\n";
  }
  return text;
}

TEST(PlyReaderTest, PassesOverListsAmongThePropertiesOfVertices) {
  SCOPED_TRACE(kSeed);
  constexpr int kPoints = 3000;
  const auto spelled = [](auto value) { return std::to_string(value) + " "; };
  for (const std::string& text :
       {ListedPly("ascii", kPoints, spelled),
        ListedPly("binary_little_endian", kPoints, [](auto v) { return LittleEndian(v); }),
        ListedPly("binary_big_endian", kPoints, [](auto v) { return BigEndian(v); })}) {
    const CloudFile file = ReadBytes("a.ply", text);
    EXPECT_THAT(file.fields, ElementsAre("x", "y", "q", "z"));
    ASSERT_EQ(file.cloud.size(), kPoints);
    for (int k = 0; k < kPoints; ++k) {
      ASSERT_EQ(file.cloud.World(k), Eigen::Vector3d(k, 2 * k, 3 * k));
    }
    CloudReadOptions options;
    options.where = {{"q", 1}};
    EXPECT_EQ(ReadBytes("a.ply", text, options).cloud.size(), kPoints / 2);
  }
}

TEST(PlyReaderTest, RefusesListsOfVerticesThatClaimMoreThanFollows) {
  const std::string list = "property list int double l\n" + std::string(kPlyDoubles);
  for (const char* count : {"3", "-1", "1.5", "1e30", "nan", "4294967295", "x"}) {
    EXPECT_THAT(
        FailureOf("a.ply", PlyHeader("ascii", 1, list) + count + " 1 2 3 and some bytes more\n"),
        HasSubstr("line 10"))
        << count;
  }
  EXPECT_THAT(FailureOf("a.ply", PlyHeader("ascii", 2, list) + "0 1 2 3\n1 7 1 2\n"),
              AllOf(HasSubstr("line 11"), HasSubstr("'z'")));
  EXPECT_THAT(FailureOf("a.ply", PlyHeader("ascii", 2, list) + "0 1 2 3\n# no vertex\n"),
              HasSubstr("after 1 of 2"));
  for (const std::int32_t count : {2, 2'000'000'000}) {
    EXPECT_THAT(FailureOf("a.ply",
                          PlyHeader("binary_little_endian", 1, list) + LittleEndian(count) +
                              std::string(24 + 8, '\0')),
                HasSubstr("after 0 of 1"));
  }
  EXPECT_THAT(FailureOf("a.ply",
                        PlyHeader("binary_little_endian", 1, list) + LittleEndian(-1) +
                            std::string(24, '\0')),
              HasSubstr("-1 entries"));
  const std::string text = ListedPly("binary_big_endian", 5, [](auto v) { return BigEndian(v); });
  const std::size_t body = text.find("end_header") + 11;
  for (std::size_t size = body; size < text.size(); ++size) {
    EXPECT_NE(FailureOf("a.ply", std::string_view(text).substr(0, size)), "") << size;
  }
}

// PCL writes NaN normals at points without neighbours.
TEST(PlyReaderTest, KeepsPointsWithoutANormal) {
  std::string text = PlyHeader(
      "binary_little_endian",
      2,
      std::string(kPlyDoubles) + "property float nx\nproperty float ny\nproperty float nz\n");
  for (const double normal : {1.0, kNaN}) {
    for (const double x : {1, 2, 3}) text += LittleEndian(x);
    for (int d = 0; d < 3; ++d) text += LittleEndian(static_cast<float>(normal));
  }
  const CloudFile file = ReadBytes("a.ply", text);
  EXPECT_EQ(file.non_finite, 0);
  EXPECT_EQ(file.cloud.normals(), (Eigen::Matrix3Xd(3, 2) << 1, 0, 1, 0, 1, 0).finished());
}

TEST(PlyReaderTest, HeadersMayEndInReturnsOnly) {
  std::string header = PlyHeader("binary_little_endian", 1, kPlyDoubles);
  std::replace(header.begin(), header.end(), '\n', '\r');
  // The first byte of x is a line feed.
  std::string body = LittleEndian(1.0) + LittleEndian(2.0) + LittleEndian(3.0);
  body[0] = '\n';
  const CloudFile file = ReadBytes("a.ply", header + body);
  EXPECT_EQ(file.cloud.World(0).tail(2), Eigen::Vector2d(2, 3));
}

TEST(PlyReaderTest, RefusesCommasThatMayBeDecimal) {
  EXPECT_THAT(FailureOf("a.ply", PlyHeader("ascii", 1, kPlyDoubles) + "1,5 2,5 3,5\n"),
              AllOf(HasSubstr("line 9"), HasSubstr("decimal")));
}

TEST(PlyReaderTest, TakesParametersAndWeightsOnlyWhenAsked) {
  const std::string text = PlyHeader("ascii",
                                     1,
                                     "property float x\nproperty float y\nproperty float "
                                     "z\nproperty float s\nproperty float t\n"
                                     "property float u\nproperty float v\nproperty float w\n") +
                           "1 2 3 0.25 0.5 9 9 -7\n";
  EXPECT_EQ(ReadBytes("a.ply", text).cloud.parameters().cols(), 0);
  EXPECT_EQ(ReadBytes("a.ply", text).cloud.weights().size(), 0);
  CloudReadOptions options;
  options.columns = {{"u", "s"}, {"v", "t"}, {"w", "2"}};
  const PointCloud cloud = ReadBytes("a.ply", text, options).cloud;
  EXPECT_EQ(cloud.parameters().col(0), Eigen::Vector2d(0.25, 0.5));
  EXPECT_EQ(cloud.weights()[0], 2);
}

TEST(PlyReaderTest, MatchesFloatsInTheirOwnPrecision) {
  CloudReadOptions options;
  options.where = {{"q", 0.1}};
  std::string text =
      PlyHeader("binary_little_endian", 1, std::string(kPlyDoubles) + "property float q\n");
  text += LittleEndian(1.0) + LittleEndian(2.0) + LittleEndian(3.0) + LittleEndian(0.1f);
  EXPECT_EQ(ReadBytes("a.ply", text, options).cloud.size(), 1);
}

TEST(PlyReaderTest, DropsAndCountsVerticesThatAreNotFinite) {
  std::string text = PlyHeader("binary_big_endian", 3, kPlyDoubles);
  for (const double z : {kNaN, 3.0, -std::numeric_limits<double>::infinity()}) {
    text += BigEndian(1.0) + BigEndian(2.0) + BigEndian(z);
  }
  const CloudFile file = ReadBytes("a.ply", text);
  EXPECT_EQ(file.cloud.size(), 1);
  EXPECT_EQ(file.non_finite, 2);
}

TEST(PlyReaderTest, NamesTheByteOfANumberTooLarge) {
  const std::string header = PlyHeader("binary_little_endian", 2, kPlyDoubles);
  std::string text = header;
  for (const double z : {1.0, 1e200})
    text += LittleEndian(1.0) + LittleEndian(2.0) + LittleEndian(z);
  EXPECT_THAT(FailureOf("a.ply", text),
              AllOf(HasSubstr("byte " + std::to_string(header.size() + 24)), HasSubstr("1e+200")));
}

TEST(PlyReaderTest, RefusesHeadersThatPromiseMoreThanTheFileHolds) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    for (const long count :
         {10L, 100'000'000L, 1'000'000'000L, 4'000'000'000L, 1'000'000'000'000L}) {
      EXPECT_THAT(FailureOf("a.ply", PlyHeader(format, count, kPlyDoubles) + "1 2 3\n4 5 6\n"),
                  HasSubstr("promises " + std::to_string(count)));
    }
  }
  EXPECT_THAT(FailureOf("a.ply", PlyHeader("ascii", 99'999'999'999'999L, kPlyDoubles)),
              HasSubstr("'99999999999999'"));
  EXPECT_THAT(
      FailureOf("a.ply",
                "ply\nformat binary_little_endian 1.0\nelement e 1000000000\n"
                "property list uchar int i\nelement vertex 1\nproperty float x\nend_header\nabc"),
      HasSubstr("element e"));
  // A list that claims to be longer than the file.
  EXPECT_THAT(
      FailureOf("a.ply",
                "ply\nformat binary_little_endian 1.0\nelement e 1\nproperty list uint double i\n"
                "element vertex 1\nproperty float x\nend_header\n\xff\xff\xff\xff garbage"),
      HasSubstr("ends after 0 of 1 of element e"));
}

TEST(PlyReaderTest, RefusesDamagedHeadersByLine) {
  EXPECT_THAT(FailureOf("a.ply", "plx\n"), HasSubstr("line 1"));
  EXPECT_THAT(FailureOf("a.ply", "ply\nformat ascii 1.0\n"), HasSubstr("end_header"));
  EXPECT_THAT(FailureOf("a.ply", "ply\nend_header\n"), HasSubstr("no format"));
  EXPECT_THAT(FailureOf("a.ply", "ply\nformat binary 1.0\n"),
              AllOf(HasSubstr("line 2"), HasSubstr("'binary'")));
  EXPECT_THAT(FailureOf("a.ply", "ply\nformat ascii 1.0\nproperty float x\n"), HasSubstr("line 3"));
  EXPECT_THAT(FailureOf("a.ply", "ply\nformat ascii 1.0\nelement vertex -1\n"), HasSubstr("'-1'"));
  EXPECT_THAT(FailureOf("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\n"),
              HasSubstr("'real'"));
  EXPECT_THAT(FailureOf("a.ply", "ply\nformat ascii 1.0\nelement face 0\nend_header\n"),
              HasSubstr("no element vertex"));
  EXPECT_THAT(FailureOf("a.ply", PlyHeader("ascii", 1, "property float a\n") + "1\n"),
              HasSubstr("no x and y"));
  EXPECT_THAT(FailureOf("a.ply", PlyHeader("ascii", 0, kPlyDoubles)), HasSubstr("no usable point"));
}

// Whatever is cut off: a reason, unless only the end of the last ASCII number is.
TEST(PlyReaderTest, RefusesEveryTruncationOfABinaryFile) {
  const std::string text = MixedPly("binary_little_endian", [](auto v) { return LittleEndian(v); });
  const std::size_t after_vertices = 5;
  for (std::size_t size = 0; size < text.size(); ++size) {
    const std::string failure = FailureOf("a.ply", std::string_view(text).substr(0, size));
    EXPECT_EQ(failure.empty(), size >= text.size() - after_vertices) << size;
  }
}

}  // namespace batten::internal::ply_reader_test
