// SPDX-License-Identifier: MIT
#include "batten/io/file_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "batten/io/read_error.h"
#include "batten/io/write_cloud.h"

namespace batten::internal::file_format_test {

using ::testing::AllOf;
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
  EXPECT_EQ(FormatOf("a.LAS"), FileFormat::kLas);
  EXPECT_EQ(FormatOf("a.obj"), FileFormat::kObj);
  EXPECT_EQ(FormatOf("a.stl"), FileFormat::kStl);
  EXPECT_EQ(FormatOf("a.off"), FileFormat::kOff);
  EXPECT_EQ(FormatOf("a.STP"), FileFormat::kStep);
  EXPECT_EQ(FormatOf("a.step"), FileFormat::kStep);
  EXPECT_EQ(FormatOf("a.json"), FileFormat::kJson);
  EXPECT_EQ(FormatOf("a.igs"), FileFormat::kIges);
  EXPECT_EQ(FormatOf("a.IGES"), FileFormat::kIges);
  EXPECT_EQ(FormatOf("a.brep"), FileFormat::kBrep);
  EXPECT_EQ(FormatOf("a.BRP"), FileFormat::kBrep);
  for (const char* path : {"a.txt",
                           "a.asc",
                           "a.pts",
                           "a.xy",
                           "a.dat",
                           "a.xyzl",
                           "a.xyzi",
                           "a.xyzn",
                           "a.xyzrgb",
                           "a.uvxyz"}) {
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
                            FileFormat::kLas,
                            FileFormat::kObj,
                            FileFormat::kStl,
                            FileFormat::kOff,
                            FileFormat::kJson,
                            FileFormat::kStep,
                            FileFormat::kIges,
                            FileFormat::kBrep}) {
    EXPECT_EQ(FormatOf("-", FormatName(format)), format);
    EXPECT_NE(IsCloudFormat(format), IsGeometryFormat(format));
    EXPECT_TRUE(IsReadable(format));
  }
}

// Points have better formats; meshes are written elsewhere.
TEST(FileFormatTest, ScansAndMeshesAreOnlyRead) {
  for (const auto format :
       {FileFormat::kLas, FileFormat::kObj, FileFormat::kStl, FileFormat::kOff}) {
    EXPECT_TRUE(IsCloudFormat(format));
    EXPECT_FALSE(IsWritable(format));
    const std::string path = std::string("a.") + FormatName(format);
    EXPECT_THROW(WriteCloud(PointCloud(Eigen::Matrix3Xd::Zero(3, 1)), path), UsageError) << path;
  }
  EXPECT_TRUE(IsWritable(FileFormat::kPly));
  EXPECT_TRUE(IsWritable(FileFormat::kStep));
}

TEST(FileFormatTest, SaysWhatToDoWithWhatItCantRead) {
  EXPECT_THAT(Advice("scan.laz"), HasSubstr("laszip"));
  EXPECT_THAT(Advice("scan.E57"), AllOf(HasSubstr("export"), HasSubstr(".las")));
  EXPECT_THAT(Advice("part.3dm"), HasSubstr("Rhino"));
  EXPECT_THAT(Advice("part.g2"), HasSubstr(".step"));
  EXPECT_THAT(Advice("a.foo"), HasSubstr("--format"));
  EXPECT_THAT(Advice("a"), HasSubstr("--format"));
  EXPECT_THAT(Advice("-"), HasSubstr("--format"));
  EXPECT_THAT(Advice("a.ply", "foo"), HasSubstr("'foo'"));
}

}  // namespace batten::internal::file_format_test
