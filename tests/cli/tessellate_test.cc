// SPDX-License-Identifier: MIT
// batten tessellate: surfaces in, a mesh out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/io/geometry_file.h"
#include "batten/io/polygon_reader.h"
#include "test_clouds.h"

namespace batten::internal::tessellate_test {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::json;

class TessellateCommandTest : public ::testing::Test {
 protected:
  std::string File(const std::string& name) const { return folder_.File(name); }

  std::string Written(const std::string& name, const std::vector<Geometry>& geometry) const {
    WriteGeometry(geometry, File(name));
    return File(name);
  }

  void ExpectRefused(const std::vector<std::string>& words, int code, const std::string& said) {
    const std::ptrdiff_t before = folder_.Entries();
    const ProgramRun run = Batten(words);
    EXPECT_EQ(run.code, code) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(said));
    EXPECT_EQ(folder_.Entries(), before);
  }

  NurbsSurface sphere_ = MakeSphere(Frame(), 1);
  NurbsSurface plane_ = MakePlane(Frame(), {0, 1}, {0, 1});
  TemporaryFolder folder_;
};

TEST_F(TessellateCommandTest, AFitWritesTrianglesWhereItsOutputIsAMesh) {
  const std::string cloud = folder_.With("cloud.xyz", ToText(WavySheet(400)));
  for (const char* name : {"a.stl", "a.obj", "a.ply", "a.glb"}) {
    const ProgramRun run = Batten({"fit", "surface", cloud, "-o", File(name)});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("surface of degree 3,3"));
    EXPECT_THAT(run.err, HasSubstr(" triangles, "));
    EXPECT_THAT(run.err, HasSubstr("of the surface"));
    EXPECT_GT(std::filesystem::file_size(File(name)), 1000u);
  }
  // The same triangles as of the surface that a file keeps; half of a tolerance bounds their
  // chords.
  ASSERT_EQ(Batten({"fit", "surface", cloud, "-o", File("a.json")}).code, 0);
  ASSERT_EQ(Batten({"tessellate", File("a.json"), "-o", File("b.obj")}).code, 0);
  EXPECT_EQ(folder_.Text("a.obj"), folder_.Text("b.obj"));
  const ProgramRun near =
      Batten({"fit", "surface", cloud, "-o", File("a.stl"), "--tolerance", "0.01"});
  EXPECT_THAT(near.err, HasSubstr("within 0.005 of"));
  const ProgramRun quiet = Batten({"fit", "surface", cloud, "-o", File("a.stl"), "--quiet"});
  EXPECT_EQ(quiet.out + quiet.err, "");
  EXPECT_EQ(Batten({"fit", "primitive", cloud, "--kind", "plane", "-o", File("p.glb")}).code,
            4);  // the sheet is no plane
}

TEST_F(TessellateCommandTest, CurvesHaveNoTriangles) {
  const std::string cloud = folder_.With("line.xyz", "0 0 0\n1 0 0\n2 0 0\n3 0 0\n4 0 0\n");
  const std::string said = "a curve has no triangles";
  ExpectRefused({"fit", "curve", cloud, "-o", File("c.stl")}, 2, said);
  ExpectRefused({"fit", "primitive", cloud, "--kind", "line", "-o", File("c.ply")}, 2, said);
  ExpectRefused({"fit", "surface", cloud, "-o", File("c.pcd")}, 2, ".stl, .obj, .ply or .glb");
}

TEST_F(TessellateCommandTest, SeveralSurfacesBecomeOneMesh) {
  const std::string in = Written("in.json", {sphere_, plane_});
  for (const char* name : {"a.stl", "a.obj", "a.ply"}) {
    const ProgramRun run =
        Batten({"tessellate", in, "-o", File(name), "--chord-tolerance", "0.01", "--json"});
    ASSERT_EQ(run.code, 0) << run.err;
    const Json file = Json::parse(run.out)["files"][0];
    EXPECT_EQ(file["kind"], "mesh");
    EXPECT_EQ(file["surfaces"], 2);
    EXPECT_EQ(file["chord_tolerance"], 0.01);
    // A closed sphere has 2 n − 4 triangles for n vertices, the plane 2 for 4.
    EXPECT_EQ(file["triangles"].get<int>(), 2 * (file["vertices"].get<int>() - 4) - 4 + 2);
    EXPECT_TRUE(std::filesystem::exists(File(name)));
  }
}

TEST_F(TessellateCommandTest, TheDefaultIsFinerThanTheSizeByAThousand) {
  const std::string in = Written("in.json", {plane_});
  const ProgramRun run = Batten({"tessellate", in, "-o", File("a.stl")});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out, HasSubstr("2 triangles, 4 vertices, within 0.00141"));
  EXPECT_EQ(Batten({"tessellate", in, "-o", File("b.stl"), "--quiet"}).out, "");
}

TEST_F(TessellateCommandTest, StandardOutputTakesTheMesh) {
  const std::string in = Written("in.json", {plane_});
  const ProgramRun run = Batten({"tessellate", in, "-o", "-", "--format", "obj"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, StartsWith("# written by batten\no surface-1\nv "));
}

// The sides of a box stand apart in JSON and are one solid in STEP.
TEST_F(TessellateCommandTest, FacesOfASolidShareTheirEdges) {
  std::vector<Geometry> sides;
  const Eigen::Vector3d o(0, 0, 0), x(3, 0, 0), y(0, 2, 0), z(0, 0, 1);
  for (const auto& [at, u, v] :
       {std::array{o, x, y}, {z, x, y}, {o, x, z}, {y, x, z}, {o, y, z}, {x, y, z}}) {
    sides.emplace_back(MakeBilinear(at, at + u, at + v, at + u + v));
  }
  const std::string apart = Written("in.json", sides);
  ASSERT_EQ(Batten({"convert", apart, File("in.step"), "--sew", "0.001"}).code, 0);
  const auto meshed = [&](const std::string& in, const std::string& out) {
    const ProgramRun run = Batten({"tessellate", in, "-o", File(out), "--json"});
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "");
    return Json::parse(run.out)["files"][0];
  };
  EXPECT_EQ(meshed(apart, "a.ply")["open_edges"], 24);
  for (const char* name : {"b.ply", "b.obj", "b.stl", "b.glb"}) {
    const Json solid = meshed(File("in.step"), name);
    EXPECT_EQ(solid["open_edges"], 0);
    EXPECT_EQ(solid["vertices"], 8);
    EXPECT_EQ(solid["triangles"], 12);
  }
  for (const char* name : {"b.ply", "b.obj"}) {
    EXPECT_EQ(ReadPolygons(File(name)).vertices.cols(), 8) << name;
  }
  EXPECT_THAT(Batten({"tessellate", File("in.step"), "-o", File("c.stl")}).out,
              HasSubstr("within 0.00374 of 6 surfaces, watertight"));
}

TEST_F(TessellateCommandTest, CurvesAreLeftOut) {
  const NurbsCurve<3> line = MakeLine(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0));
  const std::string mixed = Written("in.json", {plane_, line}), curve = Written("c.json", {line});
  const ProgramRun run = Batten({"tessellate", mixed, "-o", File("a.stl")});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.err, HasSubstr("a curve is left out: curves have no mesh"));
  ExpectRefused({"tessellate", curve, "-o", File("b.stl")}, 1, "holds no surface");
}

TEST_F(TessellateCommandTest, ConvertWritesMeshesToo) {
  const std::string in = Written("in.json", {sphere_});
  EXPECT_EQ(Batten({"convert", in, File("a.stl")}).code, 0);
  EXPECT_EQ(Batten({"convert", in, File("a.ply")}).code, 0);
  EXPECT_EQ(folder_.Entries(), 3);
}

TEST_F(TessellateCommandTest, WhatCannotBeIsRefused) {
  const std::string in = Written("in.json", {sphere_});
  ExpectRefused({"tessellate", in, "-o", File("a.step")}, 2, "meshes are written as");
  ExpectRefused(
      {"tessellate", in, "-o", File("a.stl"), "--chord-tolerance", "0"}, 2, "--chord-tolerance");
  ExpectRefused({"tessellate", in, "-o", File("a.stl"), "--chord-tolerance", "1e-15"},
                1,
                "more than the 50000000 triangles");
  ExpectRefused({"tessellate", File("none.json"), "-o", File("a.stl")}, 1, "none.json");
}

}  // namespace batten::internal::tessellate_test
