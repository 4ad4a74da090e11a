// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <string>

#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cloud_bytes.h"

namespace batten::internal::pcd_reader_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Padding, a field of three elements, packed colours and all widths.
constexpr std::string_view kMixedEntries =
    "FIELDS label _ x rgb y histogram z normal_x normal_y normal_z\n"
    "SIZE 2 1 8 4 4 1 8 4 4 4\nTYPE U U F F F I I F F F\nCOUNT 1 3 1 1 1 3 1 1 1 1\n";

float PackedColour() { return std::bit_cast<float>(std::uint32_t{0x00c86432}); }

std::string MixedRecord(double x, std::int64_t z) {
  std::string text = LittleEndian(std::uint16_t{7}) + std::string(3, '\x55') + LittleEndian(x) +
                     LittleEndian(PackedColour()) + LittleEndian(2.5f);
  for (const std::int8_t h : {1, -2, 3}) text += LittleEndian(h);
  return text + LittleEndian(z) + LittleEndian(0.0f) + LittleEndian(1.0f) + LittleEndian(0.0f);
}

void ExpectMixed(const CloudFile& file) {
  ASSERT_EQ(file.cloud.size(), 2);
  EXPECT_EQ(file.cloud.World(0), Eigen::Vector3d(500000.123456789, 2.5, -5));
  EXPECT_EQ(file.cloud.World(1), Eigen::Vector3d(500001.25, 2.5, 6));
  EXPECT_EQ(file.cloud.normals().col(1), Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(file.cloud.colours().col(1).cast<int>(), Eigen::Vector3i(200, 100, 50));
  EXPECT_THAT(file.fields,
              ElementsAre("label",
                          "x",
                          "rgb",
                          "y",
                          "histogram",
                          "histogram[1]",
                          "histogram[2]",
                          "z",
                          "normal_x",
                          "normal_y",
                          "normal_z"));
}

CloudReadOptions MixedFilter() {
  CloudReadOptions options;
  options.where = {{"label", 7}, {"histogram[1]", -2}};
  return options;
}

TEST(PcdReaderTest, ReadsBinaryFieldsOfAllTypesPastPadding) {
  ExpectMixed(ReadBytes("a.pcd",
                        PcdHeader(kMixedEntries, 2, "binary") + MixedRecord(500000.123456789, -5) +
                            MixedRecord(500001.25, 6),
                        MixedFilter()));
}

TEST(PcdReaderTest, ReadsCompressedFieldsWithPaddingStoredOrLeftOut) {
  const std::string a = MixedRecord(500000.123456789, -5), b = MixedRecord(500001.25, 6);
  const std::size_t sizes[] = {2, 3, 8, 4, 4, 3, 8, 4, 4, 4};
  for (const bool with_padding : {false, true}) {
    std::string columns;
    std::size_t at = 0;
    for (std::size_t k = 0; k < std::size(sizes); ++k) {
      if (k != 1 || with_padding) columns += a.substr(at, sizes[k]) + b.substr(at, sizes[k]);
      at += sizes[k];
    }
    ExpectMixed(
        ReadBytes("a.pcd",
                  PcdHeader(kMixedEntries, 2, "binary_compressed") + CompressedBody(columns),
                  MixedFilter()));
  }
}

TEST(PcdReaderTest, ReadsAsciiAndItsPackedColours) {
  char rgb[64];
  std::snprintf(rgb, sizeof rgb, "%.9g", static_cast<double>(PackedColour()));
  const std::string text = PcdHeader(kMixedEntries, 2, "ascii") + "7 0 0 0 500000.123456789 " +
                           rgb + " 2.5 1 -2 3 -5 0 1 0\n7 0 0 0 500001.25 " + rgb +
                           " 2.5 1 -2 3 6 0 1 0\n";
  ExpectMixed(ReadBytes("a.pcd", text, MixedFilter()));
}

TEST(PcdReaderTest, AllowsWhatOldHeadersLeaveOut) {
  EXPECT_EQ(
      ReadBytes("a.pcd",
                "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 2\nPOINTS 2\n"
                "DATA ascii\n1 2 3\n4 5 6\n")
          .cloud.size(),
      2);
  EXPECT_EQ(
      ReadBytes("a.pcd", "COLUMNS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n")
          .cloud.size(),
      1);
  EXPECT_EQ(ReadBytes("a.pcd",
                      "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 3")
                .cloud.size(),
            1);
}

TEST(PcdReaderTest, RefusesDamagedHeadersByLine) {
  const std::string fields = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n";
  EXPECT_THAT(FailureOf("a.pcd", fields + "WIDTH 2\nHEIGHT 2\nPOINTS 5\nDATA ascii\n"),
              AllOf(HasSubstr("line 7"), HasSubstr("POINTS 5")));
  EXPECT_THAT(FailureOf("a.pcd", fields + "WIDTH 1\n"), HasSubstr("without DATA"));
  EXPECT_THAT(FailureOf("a.pcd", fields + "DATA ascii\n"), HasSubstr("no WIDTH"));
  EXPECT_THAT(FailureOf("a.pcd", fields + "POINTS 1\nDATA zip\n"), HasSubstr("'zip'"));
  EXPECT_THAT(FailureOf("a.pcd", fields + "COUNT 1 1\nPOINTS 1\nDATA ascii\n"),
              HasSubstr("COUNT has 2 entries for 3"));
  EXPECT_THAT(FailureOf("a.pcd", "FIELDS x\nSIZE 3\nTYPE F\nPOINTS 1\nDATA ascii\n"),
              HasSubstr("'3'"));
  EXPECT_THAT(FailureOf("a.pcd", "FIELDS x\nSIZE 4\nTYPE F\nPOINTS -1\nDATA ascii\n"),
              HasSubstr("'-1'"));
  EXPECT_THAT(FailureOf("a.pcd", "FIELDS a b\nSIZE 4 4\nTYPE F F\nPOINTS 1\nDATA ascii\n1 2\n"),
              HasSubstr("no x and y"));
  EXPECT_THAT(FailureOf("a.pcd", "hello\n"), AllOf(HasSubstr("line 1"), HasSubstr("'hello'")));
  EXPECT_THAT(FailureOf("a.pcd", fields + "POINTS 0\nDATA ascii\n"), HasSubstr("no usable point"));
  EXPECT_THAT(FailureOf("a.pcd", fields + "POINTS 2\nDATA ascii\n1.25 2.25 3.25\n"),
              HasSubstr("ends after 1 of 2 points"));
}

TEST(PcdReaderTest, RefusesHeadersThatPromiseMoreThanTheFileHolds) {
  for (const char* data : {"ascii", "binary"}) {
    for (const long count : {10L, 1'000'000'000L, 1'000'000'000'000L}) {
      EXPECT_THAT(FailureOf("a.pcd", PcdHeader(kPcdDoubles, count, data) + "1 2 3\n"),
                  HasSubstr("promises " + std::to_string(count) + " points"));
    }
  }
  const auto compressed = [](long points, std::uint32_t packed, std::uint32_t size) {
    return FailureOf("a.pcd",
                     PcdHeader(kPcdDoubles, points, "binary_compressed") + LittleEndian(packed) +
                         LittleEndian(size) + "abc");
  };
  EXPECT_THAT(compressed(1'000'000'000, 3, 24), HasSubstr("where 1000000000 points take"));
  EXPECT_THAT(compressed(100'000'000, 2'000'000'000, 2'400'000'000u), HasSubstr("promises"));
  EXPECT_THAT(compressed(100'000'000, 3, 2'400'000'000u), HasSubstr("can't decompress"));
  EXPECT_THAT(compressed(1, 3, 24), HasSubstr("damaged"));
}

TEST(PcdReaderTest, RefusesEveryTruncation) {
  const std::string record = MixedRecord(1, 2);
  for (const std::string& text :
       {PcdHeader(kMixedEntries, 2, "binary") + record + record,
        PcdHeader(kPcdDoubles, 2, "binary_compressed") +
            CompressedBody(LittleEndian(1.0) + LittleEndian(2.0) + LittleEndian(3.0) +
                           LittleEndian(4.0) + LittleEndian(5.0) + LittleEndian(6.0))}) {
    EXPECT_EQ(FailureOf("a.pcd", text), "");
    for (std::size_t size = 0; size < text.size(); ++size) {
      EXPECT_NE(FailureOf("a.pcd", std::string_view(text).substr(0, size)), "") << size;
    }
  }
}

}  // namespace batten::internal::pcd_reader_test
