// SPDX-License-Identifier: MIT
// Scans and meshes as clouds: what info, convert and compare make of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "../io/las_bytes.h"
#include "test_clouds.h"

namespace batten::internal::cloud_formats_test {

using ::testing::HasSubstr;

constexpr const char* kTwoFacets =
    "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
    "endfacet\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0.5\nvertex 0 1 0\n"
    "endloop\nendfacet\nendsolid\n";

class CloudFormatsTest : public ::testing::Test {
 protected:
  static Json RunJson(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return Json::parse(run.out);
  }
  static void ExpectRefusal(const std::vector<std::string>& arguments,
                            int code,
                            const std::string& reason) {
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, code);
    EXPECT_THAT(run.err, HasSubstr(reason));
    EXPECT_EQ(run.error_lines(), 1) << run.err;
  }

  TemporaryFolder folder_;
  std::mt19937_64 random_{4};
  std::vector<LasPoint> points_ = RandomLasPoints(random_, 900);
  std::string las_ = folder_.With("a.las", LasBytes(points_));
  std::string stl_ = folder_.With("a.stl", kTwoFacets);
  std::string obj_ = folder_.With("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.5\nf 1 2 3\n");
};

TEST_F(CloudFormatsTest, InfoSaysFieldsAndScaleOfLas) {
  const Json info = RunJson({"info", las_});
  EXPECT_EQ(info["points"], 900);
  EXPECT_EQ(info["scale"], (Json{0.0625, 0.125, 0.25}));
  EXPECT_EQ(info["fields"][8], "classification");
  EXPECT_FALSE(RunJson({"info", obj_}).contains("scale"));
}

TEST_F(CloudFormatsTest, ClassesChooseThePointsOfLas) {
  const auto count = std::count_if(points_.begin(), points_.end(), [](const LasPoint& p) {
    return p.classification == 2 || p.classification == 6;
  });
  EXPECT_EQ(RunJson({"info", las_, "--las-class", "2,6"})["points"], count);
  const Json second = RunJson({"info", las_, "--where", "classification=2"});
  EXPECT_EQ(RunJson({"info", las_, "--las-class", "2"})["points"], second["points"]);
  ExpectRefusal({"info", las_, "--las-class", "256"}, 2, "--las-class");
  ExpectRefusal({"info", las_, "--las-class", "ground"}, 2, "'ground'");
  ExpectRefusal({"info", obj_, "--las-class", "2"}, 2, "--where");
}

TEST_F(CloudFormatsTest, TheCornersOfAMeshAreTheSameCloudInEveryFormat) {
  const std::string off =
      folder_.With("a.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0.5\n3 0 1 2\n");
  std::string first;
  for (const std::string& mesh : {stl_, obj_, off}) {
    const std::string out = folder_.File("out.ply");
    EXPECT_EQ(RunJson({"convert", mesh, out})["files"][0]["points"], 4);
    if (first.empty()) first = folder_.Text("out.ply");
    EXPECT_EQ(folder_.Text("out.ply"), first) << mesh;
  }
}

TEST_F(CloudFormatsTest, SeveralFilesAreOneCloud) {
  EXPECT_EQ(RunJson({"info", stl_, obj_})["points"], 8);
  EXPECT_EQ(RunJson({"info", stl_, obj_})["duplicates"], 4);
  const std::string out = folder_.File("all.xyz");
  EXPECT_EQ(RunJson({"convert", las_, stl_, obj_, out})["files"][0]["points"], 908);
  EXPECT_EQ(RunJson({"info", out})["points"], 908);
  const std::string plane = folder_.File("plane.json");
  ASSERT_EQ(Batten({"fit", "primitive", stl_, "-o", plane, "--kind", "plane"}).code, 0);
  const std::string report = folder_.File("r.json");
  const ProgramRun run = Batten({"compare", plane, stl_, obj_, "--report", report});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr(stl_ + " and 1 other to " + plane));
  const Json input = Json::parse(folder_.Text("r.json"))["input"];
  EXPECT_EQ(input["files"], (Json{stl_, obj_}));
  EXPECT_EQ(input["points"], 8 + input["mesh"]["sampled"].get<int>());
  ExpectRefusal({"info", plane, plane}, 2, "one such file at a time");
  ExpectRefusal({"convert", plane, plane, folder_.File("o.step")}, 2, "one such file at a time");
  ExpectRefusal({"info", stl_, plane}, 2, "geometry, not points");
}

TEST_F(CloudFormatsTest, PointsAreNotWrittenAsScansOrMeshes) {
  for (const std::string format : {"las", "obj", "stl", "off"}) {
    const std::string out = folder_.File("out." + format);
    ExpectRefusal({"convert", stl_, out}, 2, "points are written as .ply, .pcd, .xyz or .csv");
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

TEST_F(CloudFormatsTest, CompressedScansAreRefusedWithWhatToDo) {
  ExpectRefusal({"info", "scan.laz"}, 2, "laszip -i scan.laz -o scan.las");
  ExpectRefusal({"info", "scan.e57"}, 2, ".las");
  LasShape shape;
  shape.compression = 0x80;
  ExpectRefusal({"info", folder_.With("named.las", LasBytes(points_, shape))}, 1, "laszip");
}

TEST_F(CloudFormatsTest, ColumnsNamedByTheExtensionCanChooseRows) {
  const std::string labelled = folder_.With("a.xyzl", "0 0 0 1\n1 0 0 0\n0 1 0 1\n5 5 5 1\n");
  EXPECT_EQ(RunJson({"info", labelled, "--where", "label=1"})["points"], 3);
  EXPECT_EQ(
      RunJson({"info", labelled, "--where", "4=0", "--columns", "x=3,y=2,z=1"})["bounding_box"],
      (Json{{0, 0, 1}, {0, 0, 1}}));
}

}  // namespace batten::internal::cloud_formats_test
