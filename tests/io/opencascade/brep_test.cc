// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <GCE2d_MakeSegment.hxx>
#include <GProp_GProps.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <gp_Ax2.hxx>

#include <fstream>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "batten/geometry/surface_area.h"
#include "batten/io/brep_reader.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "batten/io/step_reader.h"
#include "random_geometry.h"
#include "temporary_folder.h"

namespace batten::internal::brep_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr unsigned kSeed = 20261124;

// Numbers are written with 15 digits or more.
constexpr double kPrecision = 1e-12;

TopoDS_Shape Parts() {
  TopoDS_Compound parts;
  const BRep_Builder builder;
  builder.MakeCompound(parts);
  builder.Add(parts, BRepPrimAPI_MakeBox(1, 2, 3).Shape());
  builder.Add(parts, BRepPrimAPI_MakeCylinder(gp_Ax2({5, 0, 0}, {0, 0, 1}), 1, 2).Shape());
  builder.Add(parts, BRepPrimAPI_MakeTorus(gp_Ax2({9, 9, 0}, {0, 1, 0}), 3, 1).Shape());
  return parts;
}

std::string Text(const TopoDS_Shape& shape, TopTools_FormatVersion version, bool triangles) {
  if (triangles) BRepMesh_IncrementalMesh(shape, 0.1);
  std::ostringstream stream;
  BRepTools::Write(shape, stream, triangles, triangles, version);
  return stream.str();
}

std::string Saved(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
  const std::string path = folder.File(name);
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

TEST(BrepTest, EveryVersionHoldsTheSameGeometry) {
  const TemporaryFolder folder;
  const TopoDS_Shape parts = Parts();
  const auto read = [&](TopTools_FormatVersion version, bool triangles) {
    return ReadBrepContents(Saved(folder, "a.brep", Text(parts, version, triangles))).geometry;
  };
  const std::vector<Geometry> plain = read(TopTools_FormatVersion_VERSION_1, false);
  EXPECT_EQ(plain.size(), 6u + 3u + 1u);
  for (const auto version : {TopTools_FormatVersion_VERSION_1,
                             TopTools_FormatVersion_VERSION_2,
                             TopTools_FormatVersion_VERSION_3}) {
    EXPECT_TRUE(read(version, true) == plain) << version;
  }
}

TEST(BrepTest, KeepsSolidsAndSaysNoUnit) {
  const TemporaryFolder folder;
  const GeometryContents contents = ReadBrepContents(
      Saved(folder, "a.brep", Text(Parts(), TopTools_FormatVersion_VERSION_3, false)));
  EXPECT_EQ(contents.unit, "");
  EXPECT_THAT(contents.flattened, HasSubstr("3 solids are flattened: 10 "));
  ASSERT_EQ(contents.bodies.size(), 3u);
  EXPECT_THAT(contents.bodies[1].surfaces, ElementsAre(6, 7, 8));
  EXPECT_EQ(contents.bodies[0].shared_edges, 12u);
  EXPECT_EQ(contents.bodies[1].shared_edges, 2u);
  for (const GeometryBody& body : contents.bodies) EXPECT_TRUE(body.solid && body.watertight());
}

// A slanted hole, mirrored, as modellers do it: its wall is trimmed.
TEST(BrepTest, LeftHandedSurfacesAreRead) {
  const TemporaryFolder folder;
  const TopoDS_Shape drilled =
      BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(4, 5, 6).Shape(),
                      BRepPrimAPI_MakeCylinder(gp_Ax2({2, 2, 3}, {0.2, 0, 1}), 1, 8).Shape())
          .Shape();
  gp_Trsf mirror;
  mirror.SetMirror(gp_Ax2({0, 0, 0}, {1, 0, 0}));
  const TopoDS_Shape mirrored = BRepBuilderAPI_Transform(drilled, mirror, true).Shape();
  const GeometryContents contents = ReadBrepContents(
      Saved(folder, "a.brep", Text(mirrored, TopTools_FormatVersion_VERSION_1, false)));
  ASSERT_EQ(contents.bodies.size(), 1u);
  EXPECT_TRUE(contents.bodies[0].watertight());
  const auto report =
      WriteGeometry({folder.File("b.step"), contents.geometry, contents.names, contents.bodies});
  EXPECT_TRUE(report && report->watertight());
}

// A band over a cylinder, or a cone, that winds round it `turns` times, rising by one each.
TopoDS_Shape WoundBand(const Handle(Geom_Surface) & surface, double turns) {
  const double far = 2 * std::numbers::pi * turns;
  const std::vector<gp_Pnt2d> corners = {
      {0.3, 1}, {0.3 + far, 1 + turns}, {0.3 + far, 1.5 + turns}, {0.3, 1.5}};
  BRepBuilderAPI_MakeWire wire;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    wire.Add(BRepBuilderAPI_MakeEdge(GCE2d_MakeSegment(corners[k], corners[(k + 1) % 4]).Value(),
                                     surface));
  }
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(surface, wire);
  BRepLib::BuildCurves3d(face);
  return face;
}

TEST(BrepTest, FacesMayWindRoundMoreThanOnce) {
  const TemporaryFolder folder;
  const gp_Ax3 axes({1, 2, 3}, {1, 2, 2});
  for (const double turns : {0.4, 1.5, 1.96, 3.2}) {
    for (const Handle(Geom_Surface) & surface :
         {Handle(Geom_Surface)(new Geom_CylindricalSurface(axes, 2)),
          Handle(Geom_Surface)(new Geom_ConicalSurface(axes, 0.1, 2))}) {
      SCOPED_TRACE(turns);
      const TopoDS_Shape band = WoundBand(surface, turns);
      GProp_GProps properties;
      BRepGProp::SurfaceProperties(band, properties, 1e-9);
      const std::vector<Geometry> read =
          ReadBrepContents(
              Saved(folder, "a.brep", Text(band, TopTools_FormatVersion_VERSION_3, false)))
              .geometry;
      ASSERT_EQ(read.size(), 1u);
      EXPECT_NEAR(
          Area(std::get<NurbsSurface>(read[0])), properties.Mass(), 1e-6 * properties.Mass());
      EXPECT_NO_THROW(WriteGeometry({read[0]}, folder.File("b.step")));
    }
  }
}

TEST(BrepTest, FacesThatWindRoundWithoutEndAreRefused) {
  const TemporaryFolder folder;
  const TopoDS_Shape band = WoundBand(new Geom_CylindricalSurface(gp_Ax3(), 2), 1e7);
  EXPECT_THROW(ReadBrepContents(
                   Saved(folder, "a.brep", Text(band, TopTools_FormatVersion_VERSION_3, false))),
               std::runtime_error);
}

TEST(BrepTest, WhatIsWrittenReadsBackAsItWas) {
  const TemporaryFolder folder;
  RandomGeometry random(kSeed);
  for (int round = 0; round < 10; ++round) {
    const std::vector<Geometry> geometry = {random.Surface(3, 2, round % 2 == 0, false),
                                            random.Surface(2, 4, false, true)};
    const std::string path = folder.File("a.brep");
    WriteGeometry(geometry, path);
    const std::vector<Geometry> back = ReadGeometry(path);
    ASSERT_EQ(back.size(), geometry.size());
    for (size_t k = 0; k < back.size(); ++k) {
      const auto& before = std::get<NurbsSurface>(geometry[k]);
      const auto& after = std::get<NurbsSurface>(back[k]);
      ASSERT_EQ(after.control_points().cols(), before.control_points().cols());
      const double size = before.control_points().cwiseAbs().maxCoeff();
      EXPECT_LE((after.control_points() - before.control_points()).cwiseAbs().maxCoeff(),
                kPrecision * size);
      EXPECT_EQ(after.basis_u().knots(), before.basis_u().knots());
    }
    WriteGeometry(geometry, folder.File("b.brp"));
    std::ifstream one(path), other(folder.File("b.brp"));
    std::stringstream a, b;
    a << one.rdbuf();
    b << other.rdbuf();
    EXPECT_EQ(a.str(), b.str());
  }
}

TEST(BrepTest, OpenCascadeReadsWhatIsWritten) {
  const TemporaryFolder folder;
  WriteGeometry({RandomGeometry(kSeed).Surface(3, 3, false, false)}, folder.File("a.brep"));
  TopoDS_Shape shape;
  ASSERT_TRUE(BRepTools::Read(shape, folder.File("a.brep").c_str(), BRep_Builder()));
  EXPECT_EQ(shape.ShapeType(), TopAbs_FACE);
  EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
}

// Cut anywhere, or with numbers and bytes changed: read or refused, whatever it is.
TEST(BrepTest, DamagedFilesAreReadOrRefused) {
  const TemporaryFolder folder;
  const std::string whole = Text(Parts(), TopTools_FormatVersion_VERSION_2, false);
  std::mt19937_64 random(kSeed);
  int refused = 0;
  const auto attempt = [&](const std::string& text) {
    try {
      ReadBrepContents(Saved(folder, "a.brep", text));
    } catch (const ReadError&) {
      ++refused;
    }
  };
  for (int k = 0; k < 100; ++k) attempt(whole.substr(0, random() % whole.size()));
  EXPECT_EQ(refused, 100);
  const std::string words[] = {"0", "-1", "1", "7", "13", "1e300", "*", "Fa", "2147483648", "+1"};
  for (int k = 0; k < 400; ++k) {
    std::string text = whole;
    for (int times = 1 + k % 3; times > 0; --times) {
      const size_t begin = text.find_first_not_of(" \n", random() % (text.size() - 10));
      const size_t end = text.find_first_of(" \n", begin);
      text.replace(begin, end - begin, words[random() % std::size(words)]);
    }
    attempt(text);
  }
  std::string garbage(5000, '\0');
  for (char& c : garbage) c = static_cast<char>(random());
  attempt(garbage);
  EXPECT_GT(refused, 200);
}

}  // namespace batten::internal::brep_test
