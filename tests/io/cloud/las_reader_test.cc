// SPDX-License-Identifier: MIT
#include "io/cloud/las_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "las_bytes.h"

namespace batten::internal::las_reader_test {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr unsigned kSeed = 11;
constexpr int kFormats = 11;

TEST(LasReaderTest, ReadsEveryPointFormatOfEveryVersion) {
  std::mt19937_64 random(kSeed);
  for (int minor = 0; minor <= 4; ++minor) {
    for (int format = 0; format < kFormats; ++format) {
      SCOPED_TRACE(testing::Message() << "1." << minor << ", format " << format);
      const std::vector<LasPoint> points = RandomLasPoints(random, 3000);
      LasShape shape;
      shape.minor = minor;
      shape.format = format;
      const CloudFile file = ReadBytes("a.las", LasBytes(points, shape));
      EXPECT_EQ(World(file.cloud), WorldOf(points, shape));
      EXPECT_EQ(file.points_in_file, 3000);
      EXPECT_EQ(file.scale, Eigen::Vector3d(0.0625, 0.125, 0.25));
      const bool coloured = file.cloud.colours().cols() > 0;
      EXPECT_EQ(
          coloured,
          format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10);
      // Longer records and variable records before them change nothing.
      shape.extra_bytes = 13;
      shape.variable_bytes = 4321;
      const CloudFile longer = ReadBytes("a.las", LasBytes(points, shape));
      EXPECT_EQ(World(longer.cloud), World(file.cloud));
      EXPECT_EQ(longer.cloud.colours(), file.cloud.colours());
      EXPECT_EQ(longer.fields, file.fields);
    }
  }
}

// Each field is where the specification says: rows that match are those that have the value.
TEST(LasReaderTest, EveryFieldCanChooseRows) {
  std::mt19937_64 random(kSeed);
  for (const int format : {0, 1, 3, 5, 6, 8, 10}) {
    LasShape shape;
    shape.minor = 4;
    shape.format = format;
    const std::vector<LasPoint> points = RandomLasPoints(random, 2000);
    const std::string bytes = LasBytes(points, shape);
    const auto expect = [&](const std::string& field, double value, auto number) {
      CloudReadOptions options;
      options.where = {{field, value}};
      const auto matches = std::count_if(
          points.begin(), points.end(), [&](const LasPoint& p) { return number(p) == value; });
      ASSERT_GT(matches, 0) << field;
      const CloudFile file = ReadBytes("a.las", bytes, options);
      EXPECT_EQ(file.cloud.size(), matches) << field << " in format " << format;
      EXPECT_EQ(file.filtered, 2000 - matches);
    };
    const LasPoint& p = points[7];
    expect("intensity", p.intensity, [](const LasPoint& q) { return q.intensity; });
    expect("return_number", 2, [](const LasPoint& q) { return q.return_number; });
    expect("number_of_returns", 7, [](const LasPoint& q) { return q.number_of_returns; });
    expect("classification", 31, [](const LasPoint& q) { return q.classification; });
    expect("withheld", 1, [](const LasPoint& q) { return q.withheld ? 1 : 0; });
    expect("user_data", 17, [](const LasPoint&) { return 17; });
    expect("scan_angle", -3, [](const LasPoint&) { return -3; });
    expect("point_source", 9, [](const LasPoint&) { return 9; });
    if (format != 0) expect("gps_time", p.gps_time, [](const LasPoint& q) { return q.gps_time; });
    if (format == 8 || format == 10) expect("nir", p.nir, [](const LasPoint& q) { return q.nir; });
  }
}

TEST(LasReaderTest, KeepsThePointsOfTheClassesAskedFor) {
  std::mt19937_64 random(kSeed);
  const std::vector<LasPoint> points = RandomLasPoints(random, 1000);
  CloudReadOptions options;
  options.las_classes = {2, 6};
  const auto matches = std::count_if(points.begin(), points.end(), [](const LasPoint& p) {
    return p.classification == 2 || p.classification == 6;
  });
  const CloudFile file = ReadBytes("a.las", LasBytes(points), options);
  EXPECT_EQ(file.cloud.size(), matches);
  EXPECT_EQ(file.filtered, 1000 - matches);
  EXPECT_THROW(ReadBytes("a.xyz", "1 2 3\n", options), UsageError);
}

// 1.0 has no flags beside the class.
TEST(LasReaderTest, GivesTheWholeByteToTheClassIn10Only) {
  LasPoint point;
  point.classification = 2;
  point.withheld = true;
  CloudReadOptions options;
  options.las_classes = {2};
  LasShape shape;
  shape.minor = 1;
  EXPECT_EQ(ReadBytes("a.las", LasBytes({point}, shape), options).cloud.size(), 1);
  shape.minor = 0;
  EXPECT_THAT(FailureOf("a.las", LasBytes({point}, shape), options), HasSubstr("1 filtered out"));
  options.las_classes = {130};
  EXPECT_EQ(ReadBytes("a.las", LasBytes({point}, shape), options).cloud.size(), 1);
}

TEST(LasReaderTest, ColoursOfSixteenBitsBecomeBytes) {
  LasShape shape;
  shape.format = 2;
  std::vector<LasPoint> points(300'000);  // many chunks: the wide colour comes last
  for (std::size_t k = 0; k < points.size(); ++k)
    points[k].red = static_cast<std::uint16_t>(k % 256);
  points.back().green = 255;
  const CloudFile narrow = ReadBytes("a.las", LasBytes(points, shape));
  for (Eigen::Index k = 0; k < narrow.cloud.size(); ++k) {
    ASSERT_EQ(narrow.cloud.colours()(0, k), k % 256);
  }
  EXPECT_EQ(narrow.cloud.colours()(1, 299'999), 255);

  points.back().green = 65535;
  points.back().blue = 257;
  const CloudFile wide = ReadBytes("a.las", LasBytes(points, shape));
  EXPECT_EQ(wide.cloud.colours().col(299'999).cast<int>(),
            Eigen::Vector3i(std::lround((299'999 % 256) / 257.0), 255, 1));
  for (Eigen::Index k = 0; k < wide.cloud.size(); ++k) {
    ASSERT_EQ(wide.cloud.colours()(0, k), std::lround(static_cast<double>(k % 256) / 257));
  }
}

TEST(LasReaderTest, TakesTheCountThatIsThere) {
  const std::vector<LasPoint> points(5);
  LasShape shape;
  shape.minor = 4;
  shape.format = 6;
  for (const bool long_count : {true, false}) {
    shape.long_count = long_count;
    EXPECT_EQ(ReadBytes("a.las", LasBytes(points, shape)).points_in_file, 5);
  }
}

// Millimetres at UTM coordinates: half a unit in the last place of the coordinate, no more.
TEST(LasReaderTest, KeepsTheDigitsOfGeoreferencedPoints) {
  std::mt19937_64 random(kSeed);
  const std::vector<LasPoint> points = RandomLasPoints(random, 1000);
  LasShape shape;
  for (double& s : shape.scale) s = 0.001;
  const CloudFile file = ReadBytes("a.las", LasBytes(points, shape));
  EXPECT_NE(file.cloud.origin(), Eigen::Vector3d::Zero());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const long double y = 5400000.0L + points[k].y / 1000.0L;
    const double given = file.cloud.World(static_cast<Eigen::Index>(k))[1];
    EXPECT_LE(std::abs(static_cast<double>(given - y)), std::ldexp(1.0, -30));
  }
}

TEST(LasReaderTest, RefusesCompressedPointsAndSaysHowToConvert) {
  LasShape shape;
  for (const unsigned char bits : {0x80, 0x40, 0xc0}) {
    shape.compression = bits;
    EXPECT_THAT(FailureOf("a.las", LasBytes({{}}, shape)),
                AllOf(HasSubstr("byte 104"), HasSubstr("LAZ"), HasSubstr("laszip")));
  }
}

TEST(LasReaderTest, RefusesImpossibleHeadersByByte) {
  const std::string good = LasBytes({{}, {}});
  const auto damaged = [&](std::size_t byte, const std::string& bytes) {
    std::string text = good;
    text.replace(byte, bytes.size(), bytes);
    return FailureOf("a.las", text);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(damaged(0, "LASX"), HasSubstr("LASF"));
  EXPECT_THAT(damaged(24, "\2"), AllOf(HasSubstr("byte 24"), HasSubstr("LAS 2.2")));
  EXPECT_THAT(damaged(25, "\5"), HasSubstr("LAS 1.5"));
  EXPECT_THAT(damaged(94, LittleEndian(std::uint16_t{100})), HasSubstr("byte 94"));
  EXPECT_THAT(damaged(96, LittleEndian(100u)), AllOf(HasSubstr("byte 96"), HasSubstr("header")));
  EXPECT_THAT(damaged(96, LittleEndian(4'000'000'000u)), HasSubstr("4000000000"));
  EXPECT_THAT(damaged(104, "\x0b"), AllOf(HasSubstr("byte 104"), HasSubstr("format 11")));
  EXPECT_THAT(damaged(105, LittleEndian(std::uint16_t{19})),
              AllOf(HasSubstr("byte 105"), HasSubstr("20 bytes, not 19")));
  EXPECT_THAT(damaged(131, LittleEndian(0.0)), HasSubstr("scale 0"));
  EXPECT_THAT(damaged(139, LittleEndian(nan)), AllOf(HasSubstr("byte 139"), HasSubstr("scale")));
  EXPECT_THAT(damaged(155, LittleEndian(std::numeric_limits<double>::infinity())),
              HasSubstr("offset"));
  EXPECT_THAT(damaged(155, LittleEndian(1e300)), HasSubstr("1e+300"));
  EXPECT_THAT(FailureOf("a.las", LasBytes({})), HasSubstr("no usable point"));
}

TEST(LasReaderTest, RefusesHeadersThatPromiseMoreThanTheFileHolds) {
  LasShape shape;
  for (const std::uint64_t count : {3u, 1'000'000u, 4'000'000'000u}) {
    shape.promised = count;
    EXPECT_THAT(FailureOf("a.las", LasBytes({{}, {}}, shape)),
                HasSubstr("promises " + std::to_string(count)));
  }
  shape.minor = 4;
  shape.promised = 1'000'000'000'000;
  EXPECT_THAT(FailureOf("a.las", LasBytes({{}, {}}, shape)), HasSubstr("promises 1000000000000"));
  shape.promised = std::numeric_limits<std::uint64_t>::max();
  EXPECT_THAT(FailureOf("a.las", LasBytes({{}, {}}, shape)), HasSubstr("not possible"));
}

TEST(LasReaderTest, RefusesEveryTruncation) {
  LasShape shape;
  shape.minor = 4;
  shape.format = 7;
  const std::string text = LasBytes({{}, {}}, shape);
  for (std::size_t size = 0; size < text.size(); ++size) {
    EXPECT_NE(FailureOf("a.las", std::string_view(text).substr(0, size)), "") << size;
  }
}

TEST(LasReaderTest, NamesItsFields) {
  LasShape shape;
  shape.format = 3;
  const CloudFile file = ReadBytes("a.las", LasBytes({{}}, shape));
  for (const char* field : {"x", "y", "z", "classification", "gps_time", "red"}) {
    EXPECT_THAT(file.fields, Contains(field));
  }
  EXPECT_THAT(file.fields, Not(Contains("nir")));
}

}  // namespace batten::internal::las_reader_test
