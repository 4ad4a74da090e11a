// SPDX-License-Identifier: MIT
#include "batten/io/file_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "batten/io/read_error.h"

namespace batten {
namespace {

using ::testing::HasSubstr;

std::string Advice(const std::string& path, const std::string& format = "") {
  try {
    FormatOf(path, format);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(FileFormatTest, GoesByTheExtensionInAnyCase) {
  EXPECT_EQ(FormatOf("a.pcd"), FileFormat::kPcd);
  EXPECT_EQ(FormatOf("a.b/c.PLY"), FileFormat::kPly);
  EXPECT_EQ(FormatOf("a.Xyz"), FileFormat::kXyz);
  EXPECT_EQ(FormatOf("a.csv"), FileFormat::kCsv);
  EXPECT_EQ(FormatOf("a.STP"), FileFormat::kStep);
  EXPECT_EQ(FormatOf("a.step"), FileFormat::kStep);
  EXPECT_EQ(FormatOf("a.json"), FileFormat::kJson);
  EXPECT_EQ(FormatOf("a.igs"), FileFormat::kIges);
  EXPECT_EQ(FormatOf("a.IGES"), FileFormat::kIges);
  for (const char* path : {"a.txt", "a.asc", "a.pts", "a.xy", "a.dat"}) {
    EXPECT_EQ(FormatOf(path), FileFormat::kText) << path;
  }
}

TEST(FileFormatTest, LetsAWordOverruleTheExtension) {
  EXPECT_EQ(FormatOf("a.ply", "text"), FileFormat::kText);
  EXPECT_EQ(FormatOf("-", "PCD"), FileFormat::kPcd);
  EXPECT_EQ(FormatOf("a.laz", "xyz"), FileFormat::kXyz);
}

TEST(FileFormatTest, EveryNameIsAWordForItself) {
  for (const auto format : {FileFormat::kPcd,
                            FileFormat::kPly,
                            FileFormat::kText,
                            FileFormat::kXyz,
                            FileFormat::kCsv,
                            FileFormat::kJson,
                            FileFormat::kStep,
                            FileFormat::kIges}) {
    EXPECT_EQ(FormatOf("-", FormatName(format)), format);
    EXPECT_NE(IsCloudFormat(format), IsGeometryFormat(format));
    EXPECT_TRUE(IsReadable(format) && IsWritable(format));
  }
}

TEST(FileFormatTest, SaysWhatToDoWithWhatItCantRead) {
  EXPECT_THAT(Advice("scan.laz"), HasSubstr("laszip"));
  EXPECT_THAT(Advice("scan.E57"), HasSubstr("export"));
  EXPECT_THAT(Advice("part.3dm"), HasSubstr("Rhino"));
  EXPECT_THAT(Advice("part.g2"), HasSubstr(".step"));
  EXPECT_THAT(Advice("part.brep"), HasSubstr(".step"));
  for (const char* path : {"a.las", "a.obj", "a.stl", "a.off", "a.glb"}) {
    EXPECT_THAT(Advice(path), HasSubstr("not in this version")) << path;
  }
  EXPECT_THAT(Advice("a.foo"), HasSubstr("--format"));
  EXPECT_THAT(Advice("a"), HasSubstr("--format"));
  EXPECT_THAT(Advice("-"), HasSubstr("--format"));
  EXPECT_THAT(Advice("a.ply", "foo"), HasSubstr("'foo'"));
}

}  // namespace
}  // namespace batten
