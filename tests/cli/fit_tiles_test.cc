// SPDX-License-Identifier: MIT
// Laws of fit surface --tiles: faces that are parts of one surface, in every format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "batten/io/geometry_file.h"
#include "test_clouds.h"
#include "tolerances.h"

namespace batten::internal::fit_tiles_command_test {

using ::testing::HasSubstr;

class FitTilesCommandTest : public ::testing::Test {
 protected:
  ProgramRun Fit(std::vector<std::string> words) {
    words.insert(words.begin(), {"fit", "surface", a_, b_});
    return Batten(words);
  }
  std::vector<NurbsSurface> Faces(const std::string& file) const {
    std::vector<NurbsSurface> faces;
    for (const Geometry& one : ReadGeometry(folder_.File(file)))
      faces.push_back(std::get<NurbsSurface>(one));
    return faces;
  }

  TemporaryFolder folder_;
  std::string a_ = folder_.With("a.xyz", ToText(WavySheet(20000))),
              b_ = folder_.With("b.xyz", ToText(WavySheet(10000, 2)));
};

TEST_F(FitTilesCommandTest, WritesAFaceForEachTile) {
  for (const std::string name : {"t.json", "t.step"}) {
    SCOPED_TRACE(name);
    const ProgramRun run = Fit({"--tiles", "3x2", "-o", folder_.File(name), "--json"});
    ASSERT_EQ(run.code, 0) << run.err;
    const Json report = Json::parse(run.out);
    ASSERT_EQ(report["tiles"].size(), 6);
    int points = 0;
    for (const Json& tile : report["tiles"])
      points += tile["points"].get<int>() + tile["outliers"].get<int>();
    EXPECT_EQ(points, 30000);
    const std::vector<NurbsSurface> faces = Faces(name);
    ASSERT_EQ(faces.size(), 6);
    // The edge u = high of a face is the edge u = low of the one two on.
    for (int k = 0; k < 4; ++k) {
      const NurbsSurface &face = faces[k], &next = faces[k + 2];
      ASSERT_EQ(face.size_v(), next.size_v());
      EXPECT_EQ(face.control_points().rightCols(face.size_v()),
                next.control_points().leftCols(next.size_v()));
    }
  }
}

TEST_F(FitTilesCommandTest, OneSurfaceIsTheSameShape) {
  ASSERT_EQ(Fit({"--tiles", "3,2", "-o", folder_.File("each.json")}).code, 0);
  ASSERT_EQ(Fit({"--tiles", "3,2", "--tile-faces", "one", "-o", folder_.File("one.json")}).code, 0);
  const std::vector<NurbsSurface> each = Faces("each.json"), one = Faces("one.json");
  ASSERT_EQ(one.size(), 1);
  for (const NurbsSurface& face : each) {
    const double u = (face.basis_u().lower() + face.basis_u().upper()) / 2,
                 v = (face.basis_v().lower() + face.basis_v().upper()) / 2;
    EXPECT_LT((face.At(u, v) - one[0].At(u, v)).norm(), kRounding * one[0].At(u, v).norm());
  }
}

TEST_F(FitTilesCommandTest, OrderOfFilesDoesNotMatter) {
  const auto net = [&](const std::vector<std::string>& files) {
    std::vector<std::string> words = {"fit", "surface"};
    words.insert(words.end(), files.begin(), files.end());
    words.insert(words.end(),
                 {"--tiles", "2x2", "--tile-faces", "one", "-o", folder_.File("o.json")});
    EXPECT_EQ(Batten(words).code, 0);
    return Faces("o.json").front().control_points();
  };
  const Eigen::Matrix3Xd forwards = net({a_, b_}), backwards = net({b_, a_});
  ASSERT_EQ(forwards.cols(), backwards.cols());
  EXPECT_LT((forwards - backwards).cwiseAbs().maxCoeff(),
            kIterated * forwards.cwiseAbs().maxCoeff());
}

TEST_F(FitTilesCommandTest, WhatCannotBeIsRefused) {
  const auto refused = [&](std::vector<std::string> words) {
    words.insert(words.end(), {"-o", folder_.File("x.json")});
    const ProgramRun run = Fit(words);
    EXPECT_EQ(run.code, 2);
    EXPECT_EQ(run.error_lines(), 1);
    return run.err;
  };
  EXPECT_THAT(refused({"--tiles", "3by2"}), HasSubstr("--tiles: '3by2'"));
  EXPECT_THAT(refused({"--tiles", "0x2"}), HasSubstr("--tiles: '0x2'"));
  EXPECT_THAT(refused({"--tiles", "2x2", "--thin", "1"}),
              HasSubstr("--thin: needs all points in memory at once; with --tiles"));
  EXPECT_THAT(refused({"--tiles", "2x2", "--memory", "1GB"}), HasSubstr("--max-control-points"));
  EXPECT_THAT(refused({"--tile-faces", "one"}), HasSubstr("needs --tiles"));
}

}  // namespace batten::internal::fit_tiles_command_test
