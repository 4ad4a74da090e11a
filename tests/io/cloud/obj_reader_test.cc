// SPDX-License-Identifier: MIT
#include "io/cloud/obj_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cloud_bytes.h"

namespace batten::internal::obj_reader_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const Eigen::Matrix3Xd& TwoPoints() {
  static const Eigen::Matrix3Xd points =
      (Eigen::Matrix3Xd(3, 2) << 1, -4, 2, 5.5, 3, 0.06).finished();
  return points;
}

TEST(ObjReaderTest, TakesVerticesAndPassesOverTheRest) {
  for (const char* text :
       {"v 1 2 3\nv -4 5.5 .06\n",
        "# made by hand\r\nmtllib a.mtl\r\no part\r\nv 1 2 3\r\nv\t-4\t5.5  6e-2  \r\ns off\r\n"
        "usemtl steel\r\nf 1 2 2\r\n",
        "v 1 2 3 1.0\nv -4 5.5 0.06 0.5\nvt 0.5 0.5\nvt 1 1 0\nf 1/1 2/2 1/2\nl 1 2\n",
        "g a b\nv 1 2 3 # first\nf 1 \\\n2 \\\n 1\n\n  # indented comment\nv -4 5.5 0.06",
        "vp 0.5 0.25\nv 1 2 3\ncstype bspline\ncurv 0 1 1 2\nparm u 0 1\nend\nv -4 5.5 0.06\n"}) {
    const CloudFile file = ReadBytes("a.obj", text);
    EXPECT_EQ(World(file.cloud), TwoPoints()) << text;
    EXPECT_EQ(file.points_in_file, 2);
    EXPECT_THAT(file.fields, ElementsAre("x", "y", "z"));
    EXPECT_EQ(file.cloud.colours().cols(), 0);
  }
}

TEST(ObjReaderTest, LinesThatGoOnAreOne) {
  for (const char* text : {"v 1 2 \\\n3\nv -4\\\r\n5.5\\\r\n.06\r\n",
                           "v \\\n1 2 3\nv -4 5.5 .06 \\",
                           "f 1 2 \\\nv 9 9 9\nv 1 2 3\nv -4 5.5 .06\nf 2 1 \\\n1 \\\n",
                           "# made in C:\\\nv 1 2 3 # of C:\\\nv -4 5.5 \\\n.06 # of C:\\\n",
                           "v 1 2 3\rv -4 5.5 \\\r.06\r"}) {
    EXPECT_EQ(World(ReadBytes("a.obj", text).cloud), TwoPoints()) << text;
  }
  const CloudFile turned = ReadBytes("a.obj", "v 1 2 3\nvn 0 \\\n0.6 \\\n0.8\n");
  EXPECT_EQ(turned.cloud.normals().col(0), Eigen::Vector3d(0, 0.6, 0.8));
}

TEST(ObjReaderTest, RefusesWhatGoesOnWrongly) {
  EXPECT_THAT(FailureOf("a.obj", "v 1 2 3\nv 1 2 \\\nv 4 5 6\n"),
              AllOf(HasSubstr("line 2"), HasSubstr("'v'")));
  EXPECT_THAT(FailureOf("a.obj", "v 1 \\\n2 \\\n"),
              AllOf(HasSubstr("line 1"), HasSubstr("found 2")));
  std::string endless = "v 1 2 3 \\\n";
  for (int k = 0; k < 100'000; ++k) endless += "4 \\\n";
  EXPECT_THAT(FailureOf("a.obj", endless), HasSubstr("too many lines"));
  EXPECT_THAT(FailureOf("a.obj", "v 1,5 2,5 3,5\n"),
              AllOf(HasSubstr("line 1"), HasSubstr("'1,5'")));
}

TEST(ObjReaderTest, ColoursCountToOneOrTo255) {
  const CloudFile unit = ReadBytes("a.obj", "v 1 2 3 0 0.5 1\nv -4 5.5 .06 1 0 0.1\n");
  EXPECT_EQ(unit.cloud.colours().cast<int>(),
            (Eigen::Matrix<int, 3, 2>() << 0, 255, 128, 0, 255, 26).finished());
  const CloudFile bytes = ReadBytes("a.obj", "v 1 2 3 0 1 1\nv -4 5.5 .06 128 255 2\n");
  EXPECT_EQ(bytes.cloud.colours().cast<int>(),
            (Eigen::Matrix<int, 3, 2>() << 0, 128, 1, 255, 1, 2).finished());
  // Colours are those of all points or of none.
  const CloudFile mixed = ReadBytes("a.obj", "v 1 2 3 0 1 1\nv -4 5.5 .06\n");
  EXPECT_EQ(mixed.cloud.colours().cols(), 0);
  EXPECT_EQ(World(mixed.cloud), TwoPoints());
}

TEST(ObjReaderTest, NormalsBelongToThePointsWhereThereAreAsMany) {
  const CloudFile equal =
      ReadBytes("a.obj", "vn 0 0 1\nv 1 2 3\nv -4 5.5 .06\nvn 0 0.6 -0.8\nf 1//1 2//2 1//1\n");
  EXPECT_EQ(equal.cloud.normals().col(1), Eigen::Vector3d(0, 0.6, -0.8));
  EXPECT_THAT(equal.fields, ElementsAre("x", "y", "z", "nx", "ny", "nz"));
  const CloudFile fewer = ReadBytes("a.obj", "vn 0 0 1\nv 1 2 3\nv -4 5.5 .06\n");
  EXPECT_EQ(fewer.cloud.normals().cols(), 0);
  EXPECT_EQ(World(fewer.cloud), TwoPoints());
}

// Whatever is filtered out: each point keeps the normal and the colour of its own row.
TEST(ObjReaderTest, AttributesStayWithTheirPoints) {
  std::mt19937_64 random(5);
  constexpr int kPoints = 50'000;
  const Eigen::Matrix3Xd points = RandomPoints(random, kPoints, 1);
  std::string vertices, normals;
  char row[160];
  for (int k = 0; k < kPoints; ++k) {
    const char* z = k % 7 == 3 ? "nan" : "0";
    std::snprintf(row,
                  sizeof row,
                  "v %.17g %.17g %s %d %d %d\n",
                  points(0, k),
                  points(1, k),
                  z,
                  k % 256,
                  k / 256,
                  9);
    vertices += row;
    std::snprintf(row, sizeof row, "vn %d %.17g 1\n", k, points(0, k));
    normals += row;
  }
  CloudReadOptions options;
  options.box = Eigen::AlignedBox3d(Eigen::Vector3d(-0.5, -0.5, -1), Eigen::Vector3d(1, 1, 1));
  const CloudFile file = ReadBytes("a.obj", vertices + normals, options);
  const PointCloud& cloud = file.cloud;
  ASSERT_GT(cloud.size(), kPoints / 3);
  EXPECT_EQ(file.non_finite, (kPoints + 3) / 7);
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const auto own = static_cast<Eigen::Index>(cloud.normals()(0, k));
    ASSERT_EQ(cloud.World(k)[0], points(0, own));
    ASSERT_EQ(cloud.normals()(1, k), points(0, own));
    ASSERT_EQ(cloud.colours()(0, k) + 256 * cloud.colours()(1, k), own);
  }
}

TEST(ObjReaderTest, RefusesWhatIsNoObjByLine) {
  EXPECT_THAT(FailureOf("a.obj", "v 1 2 3\nv 1 2\n"),
              AllOf(HasSubstr("line 2"), HasSubstr("found 2")));
  EXPECT_THAT(FailureOf("a.obj", "v 1 2 x\n"), AllOf(HasSubstr("line 1"), HasSubstr("'x'")));
  EXPECT_THAT(FailureOf("a.obj", "v 1 2 3\n4 5 6\n"), AllOf(HasSubstr("line 2"), HasSubstr("'4")));
  EXPECT_THAT(FailureOf("a.obj", "v 1 2 3\nvn 1 2\n"), HasSubstr("line 2"));
  EXPECT_THAT(FailureOf("a.obj",
                        std::string("\x7f"
                                    "ELF\0\1",
                                    6)),
              HasSubstr("'\\x7fELF"));
  EXPECT_THAT(FailureOf("a.obj", std::string(1 << 20, 'v')), HasSubstr("longer than"));
  EXPECT_THAT(FailureOf("a.obj", "v 1 2 3\nv 1 1e308 2\n"),
              AllOf(HasSubstr("vertex 2"), HasSubstr("1e+308")));
  EXPECT_THAT(FailureOf("a.obj", "# nothing\nf 1 2 3\n"), HasSubstr("no usable point"));
}

}  // namespace batten::internal::obj_reader_test
