// SPDX-License-Identifier: MIT
#include "io/cloud/off_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cloud_bytes.h"

namespace batten::internal::off_reader_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const Eigen::Matrix3Xd& TwoPoints() {
  static const Eigen::Matrix3Xd points =
      (Eigen::Matrix3Xd(3, 2) << 1, -4, 2, 5.5, 3, 0.06).finished();
  return points;
}

TEST(OffReaderTest, TakesVerticesInEverySpellingOfTheHeader) {
  for (const char* text : {"OFF\n2 1 0\n1 2 3\n-4 5.5 .06\n3 0 1 1\n",
                           "OFF 2 0 0\n1 2 3\n-4 5.5 .06\n",
                           "# made by hand\nOFF # the word\n\n2 0 0 # counts\n# one\n1 2 3\n\n"
                           "-4\t5.5 6e-2 # two\n",
                           "\xEF\xBB\xBFOFF\r\n2 0 0\r\n1 2 3\r\n-4 5.5 0.06\r\n",
                           "2 0 0\n1 2 3\n-4 5.5 .06",
                           "STOFF\n2 0 0\n1 2 3 0.5 0.5\n-4 5.5 .06 1 1\n"}) {
    const CloudFile file = ReadBytes("a.off", text);
    EXPECT_EQ(World(file.cloud), TwoPoints()) << text;
    EXPECT_EQ(file.points_in_file, 2);
    EXPECT_EQ(file.cloud.normals().cols(), 0);
    EXPECT_EQ(file.cloud.colours().cols(), 0);
    EXPECT_EQ(file.cloud.parameters().cols(), 0);
  }
}

TEST(OffReaderTest, KeepsNormalsAndColours) {
  const CloudFile normals = ReadBytes("a.off", "NOFF\n1 0 0\n1 2 3 0 0.6 0.8\n");
  EXPECT_EQ(normals.cloud.normals().col(0), Eigen::Vector3d(0, 0.6, 0.8));
  for (const char* text : {"COFF\n1 0 0\n1 2 3 255 128 0 255\n",
                           "COFF\n1 0 0\n1 2 3 255 128 0\n",
                           "COFF\n1 0 0\n1 2 3 1.0 0.5 0 0.7\n",
                           "OFF\n1 0 0\n1 2 3 255 128 0\n",
                           "STCOFF\n1 0 0\n1 2 3 1 0.5 0 1 0.25 0.25\n"}) {
    EXPECT_EQ(ReadBytes("a.off", text).cloud.colours().col(0).cast<int>(),
              Eigen::Vector3i(255, 128, 0))
        << text;
  }
  const CloudFile both = ReadBytes("a.off", "CNOFF\n1 0 0\n1 2 3 0 0 1 0.2 0.4 0.6 1\n");
  EXPECT_EQ(both.cloud.normals().col(0), Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(both.cloud.colours().col(0).cast<int>(), Eigen::Vector3i(51, 102, 153));
  EXPECT_THAT(both.fields,
              ElementsAre("x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha"));
}

TEST(OffReaderTest, RefusesWhatIsNoTextOfThreeDimensionsByLine) {
  EXPECT_THAT(FailureOf("a.off", "OFX\n"), AllOf(HasSubstr("line 1"), HasSubstr("'OFX'")));
  EXPECT_THAT(FailureOf("a.off", "OFF BINARY\n\0\0\0\1"), HasSubstr("binary"));
  EXPECT_THAT(FailureOf("a.off", "4OFF\n1 0 0\n1 2 3 1\n"), HasSubstr("three dimensions"));
  EXPECT_THAT(FailureOf("a.off", "nOFF\n4\n1 0 0\n1 2 3 1\n"), HasSubstr("three dimensions"));
  EXPECT_THAT(FailureOf("a.off", "OFF\nx 0 0\n"), AllOf(HasSubstr("line 2"), HasSubstr("'x'")));
  EXPECT_THAT(FailureOf("a.off", "OFF\n-1 0 0\n"), HasSubstr("'-1'"));
  EXPECT_THAT(FailureOf("a.off", "OFF\n1.5 0 0\n"), HasSubstr("'1.5'"));
  EXPECT_THAT(FailureOf("a.off", "OFF\n"), HasSubstr("ends in the header"));
  EXPECT_THAT(FailureOf("a.off", "OFF\n0 0 0\n"), HasSubstr("no usable point"));
  EXPECT_THAT(FailureOf("a.off", "OFF\n2 0 0\n1 2 3\n4 x 6\n"),
              AllOf(HasSubstr("line 4"), HasSubstr("'x'")));
  EXPECT_THAT(FailureOf("a.off", "OFF\n2 0 0\n1 2 3\n4 5\n          "),
              AllOf(HasSubstr("line 4"), HasSubstr("expected 3 columns")));
  EXPECT_THAT(FailureOf("a.off", "OFF\n1 0 0\n1 2 1e308\n"),
              AllOf(HasSubstr("line 3"), HasSubstr("1e+308")));
}

TEST(OffReaderTest, HoldsTheCountAgainstTheFile) {
  for (const char* count : {"3", "1000000", "1000000000000"}) {
    EXPECT_THAT(FailureOf("a.off", "OFF\n" + std::string(count) + " 0 0\n1 2 3\n4 5 6\n"),
                HasSubstr("promises " + std::string(count)));
  }
  EXPECT_THAT(FailureOf("a.off", "OFF\n99999999999999 0 0\n1 2 3\n"), HasSubstr("99999999999999"));
  EXPECT_THAT(FailureOf("a.off", "OFF\n3 0 0\n1.25 2.25 3.25\n4 5 6\n"),
              HasSubstr("ends after 2 of 3 points"));
}

}  // namespace batten::internal::off_reader_test
