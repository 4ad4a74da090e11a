// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <GProp_GProps.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_Ax2.hxx>

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "batten/geometry/make_surface.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "temporary_folder.h"

namespace batten::internal::sewing_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Volumes by OpenCASCADE's adaptive quadrature (its usual one is off by 3e-4 on trimmed cylinders),
// of faces whose edges are within 1e-6 of the size.
constexpr double kQuadrature = 1e-9, kVolume = 1e-6;

using Corners = std::array<Eigen::Vector3d, 4>;

Geometry Patch(const Corners& c) { return MakeBilinear(c[0], c[1], c[2], c[3]); }

// The six sides of a box from `low` to `high`; their normals point anywhere.
std::vector<Geometry> BoxSides(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const auto at = [&](int x, int y, int z) {
    return Eigen::Vector3d(x ? high[0] : low[0], y ? high[1] : low[1], z ? high[2] : low[2]);
  };
  return {Patch({at(0, 0, 0), at(1, 0, 0), at(0, 1, 0), at(1, 1, 0)}),
          Patch({at(0, 0, 1), at(1, 0, 1), at(0, 1, 1), at(1, 1, 1)}),
          Patch({at(0, 0, 0), at(1, 0, 0), at(0, 0, 1), at(1, 0, 1)}),
          Patch({at(0, 1, 0), at(1, 1, 0), at(0, 1, 1), at(1, 1, 1)}),
          Patch({at(0, 0, 0), at(0, 1, 0), at(0, 0, 1), at(0, 1, 1)}),
          Patch({at(1, 0, 0), at(1, 1, 0), at(1, 0, 1), at(1, 1, 1)})};
}

// By OpenCASCADE alone.
TopoDS_Shape ReadBack(const std::string& path) {
  TopoDS_Shape shape;
  if (path.ends_with(".brep")) {
    EXPECT_TRUE(BRepTools::Read(shape, path.c_str(), BRep_Builder()));
    return shape;
  }
  STEPControl_Controller::Init();
  STEPControl_Reader reader;
  EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
  reader.TransferRoots();
  return reader.OneShape();
}

int Count(const TopoDS_Shape& shape, TopAbs_ShapeEnum type) {
  int count = 0;
  for (TopExp_Explorer each(shape, type); each.More(); each.Next()) ++count;
  return count;
}

double Volume(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, kQuadrature, false);
  return properties.Mass();
}

std::string Step(const TemporaryFolder& folder, const TopoDS_Shape& shape) {
  const std::string path = folder.File("in.brep");
  BRepTools::Write(shape, path.c_str());
  return path;
}

// Reads and writes with what belongs together, and nothing said of sewing.
SewingReport Carried(const std::string& from, const std::string& to) {
  GeometryContents read = ReadGeometryContents(from);
  const auto report = WriteGeometry({to, read.geometry, read.names, read.bodies});
  EXPECT_TRUE(report.has_value());
  return report.value_or(SewingReport());
}

TEST(SewingTest, SixSidesBecomeASolidOfTheirVolume) {
  const TemporaryFolder folder;
  for (const std::string name : {"box.step", "box.brep"}) {
    const GeometryFile file{folder.File(name), BoxSides({1, 2, 3}, {3, 5, 7})};
    const SewingReport report = WriteGeometry(file, {.sew = 1e-6}).value();
    EXPECT_TRUE(report.watertight());
    EXPECT_EQ(report.surfaces, 6u);
    EXPECT_EQ(report.solids, 1u);
    EXPECT_EQ(report.shells + report.loose, 0u);
    EXPECT_EQ(report.shared_edges, 12u);
    EXPECT_LE(report.largest_gap, 1e-12);
    const TopoDS_Shape shape = ReadBack(file.path);
    EXPECT_EQ(Count(shape, TopAbs_SOLID), 1) << name;
    EXPECT_EQ(Count(shape, TopAbs_FACE), 6) << name;
    EXPECT_NEAR(Volume(shape), 2 * 3 * 4, kVolume * 24) << name;  // positive: it faces outwards
    const GeometryContents back = ReadGeometryContents(file.path);
    ASSERT_EQ(back.bodies.size(), 1u);
    EXPECT_TRUE(back.bodies[0].solid && back.bodies[0].watertight());
  }
}

TEST(SewingTest, NothingIsSewnUnasked) {
  const TemporaryFolder folder;
  const GeometryFile file{folder.File("box.step"), BoxSides({0, 0, 0}, {1, 1, 1})};
  EXPECT_FALSE(WriteGeometry(file).has_value());
  EXPECT_EQ(Count(ReadBack(file.path), TopAbs_SOLID), 0);
  EXPECT_TRUE(ReadGeometryContents(file.path).bodies.empty());
}

TEST(SewingTest, WiderGapsThanTheToleranceStayAndAreSaid) {
  const TemporaryFolder folder;
  constexpr double kGap = 0.02;
  const std::vector<Geometry> pair = {
      Patch({Eigen::Vector3d(0, 0, 0), {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}),
      Patch({Eigen::Vector3d(1 + kGap, 0, 0), {2, 0, 0}, {1 + kGap, 1, 0}, {2, 1, 0}})};
  const GeometryFile file{folder.File("pair.step"), pair};
  const SewingReport apart = WriteGeometry(file, {.sew = kGap / 2}).value();
  EXPECT_EQ(apart.loose, 2u);
  EXPECT_EQ(apart.free_edges, 8u);
  EXPECT_FALSE(apart.watertight());
  EXPECT_NEAR(apart.nearest_gap.value(), kGap, 1e-9);
  const SewingReport sewn = WriteGeometry(file, {.sew = 2 * kGap}).value();
  EXPECT_EQ(sewn.shells, 1u);
  EXPECT_EQ(sewn.loose, 0u);
  EXPECT_EQ(sewn.shared_edges, 1u);
  EXPECT_EQ(sewn.free_edges, 6u);
  EXPECT_NEAR(sewn.largest_gap, kGap, 1e-6);
  const GeometryContents back = ReadGeometryContents(file.path);
  ASSERT_EQ(back.bodies.size(), 1u);
  EXPECT_FALSE(back.bodies[0].solid);
  EXPECT_EQ(back.bodies[0].free_edges.size(), 6u);
  EXPECT_GE(back.bodies[0].tolerance, kGap / 2);
  EXPECT_EQ(Carried(file.path, folder.File("again.step")).shells, 1u);
}

// Sewn so widely the three would cross themselves.
TEST(SewingTest, WhatWouldMakeNoValidShapeIsLeftAsItWas) {
  const TemporaryFolder folder;
  const std::vector<Geometry> three = {
      Patch({Eigen::Vector3d(0, 0, 0), {1, 1, 1}, {0, 1, 0}, {1, 2, 2}}),
      Patch({Eigen::Vector3d(0.5, 0, 0.5), {0.5, 1, 1}, {0.5, 0.3, 0.5}, {0.5, 1.3, 1}}),
      Patch({Eigen::Vector3d(0.5, 0, 0), {0.5, 0, 1}, {1.5, 0.3, 0}, {1.5, 0.3, 1}})};
  const GeometryFile file{folder.File("three.step"), three};
  const SewingReport report = WriteGeometry(file, {.sew = 0.6}).value();
  EXPECT_EQ(report.invalid, 3u);
  EXPECT_EQ(report.loose, 3u);
  EXPECT_EQ(report.free_edges, 12u);
  const TopoDS_Shape back = ReadBack(file.path);
  EXPECT_EQ(Count(back, TopAbs_FACE), 3);
  EXPECT_TRUE(BRepCheck_Analyzer(back).IsValid());
}

TEST(SewingTest, ClosedShellsOfASolidAreItsVoidsWhereTheyLieInIt) {
  const TemporaryFolder folder;
  for (const bool inside : {true, false}) {
    std::vector<Geometry> sides = BoxSides({0, 0, 0}, {4, 4, 4});
    const Eigen::Vector3d corner(inside ? 1 : 6, 1, 1);
    for (Geometry& side : BoxSides(corner, corner.array() + 2)) sides.push_back(std::move(side));
    GeometryFile file{folder.File("two.step"), sides};
    file.bodies = {{.solid = true, .tolerance = 1e-6}};
    for (size_t k = 0; k < sides.size(); ++k) file.bodies[0].surfaces.push_back(k);
    const SewingReport report = WriteGeometry(file).value();
    EXPECT_TRUE(report.watertight());
    EXPECT_EQ(report.solids, inside ? 1u : 2u);
    EXPECT_NEAR(Volume(ReadBack(file.path)), inside ? 64 - 8 : 64 + 8, kVolume * 64);
  }
}

// Half an edge against a whole one: edges are cut where only parts of them meet.
TEST(SewingTest, EdgesAreCutWhereOthersEnd) {
  const TemporaryFolder folder;
  const std::vector<Geometry> tee = {
      Patch({Eigen::Vector3d(0, 0, 0), {2, 0, 0}, {0, 1, 0}, {2, 1, 0}}),
      Patch({Eigen::Vector3d(0, -1, 0), {1, -1, 0}, {0, 0, 0}, {1, 0, 0}}),
      Patch({Eigen::Vector3d(1, -1, 0), {2, -1, 0}, {1, 0, 0}, {2, 0, 0}})};
  const SewingReport report = WriteGeometry({folder.File("tee.step"), tee}, {.sew = 1e-6}).value();
  EXPECT_EQ(report.shells, 1u);
  EXPECT_EQ(report.shared_edges, 3u);
  EXPECT_EQ(report.free_edges, 7u);
}

TEST(SewingTest, SolidsStaySolidsByThemselves) {
  const TemporaryFolder folder;
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(4, 5, 6).Shape();
  const TopoDS_Shape drill = BRepPrimAPI_MakeCylinder(gp_Ax2({2, 2, -1}, {0, 0, 1}), 1, 8).Shape();
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(gp_Pnt(2, 2, 3), 1.5).Shape();
  const TopoDS_Shape half = BRepPrimAPI_MakeBox(gp_Pnt(-3, 2, -3), gp_Pnt(9, 9, 3.5)).Shape();
  const TopoDS_Shape shapes[] = {box,
                                 BRepPrimAPI_MakeCylinder(2, 3).Shape(),
                                 ball,
                                 BRepAlgoAPI_Cut(box, drill).Shape(),
                                 BRepAlgoAPI_Cut(box, ball).Shape(),
                                 // Halves, bounded by the seam of the whole.
                                 BRepAlgoAPI_Common(half, ball).Shape(),
                                 BRepAlgoAPI_Fuse(half, drill).Shape()};
  for (size_t k = 0; k < std::size(shapes); ++k) {
    for (const std::string out : {"out.step", "out.brep"}) {
      const SewingReport report = Carried(Step(folder, shapes[k]), folder.File(out));
      EXPECT_TRUE(report.watertight()) << k << out;
      EXPECT_EQ(report.solids, 1u) << k << out;
      const TopoDS_Shape back = ReadBack(folder.File(out));
      EXPECT_EQ(Count(back, TopAbs_SOLID), 1) << k << out;
      EXPECT_EQ(Count(back, TopAbs_FACE), Count(shapes[k], TopAbs_FACE)) << k << out;
      EXPECT_EQ(Count(back, TopAbs_SHELL), Count(shapes[k], TopAbs_SHELL)) << k << out;
      EXPECT_NEAR(Volume(back), Volume(shapes[k]), kVolume * Volume(shapes[k])) << k << out;
    }
  }
}

// Two boxes that touch are two solids still: what one file's bodies are stays apart.
TEST(SewingTest, BodiesAreNotSewnToOneAnother) {
  const TemporaryFolder folder;
  TopoDS_Compound pair;
  const BRep_Builder builder;
  builder.MakeCompound(pair);
  builder.Add(pair, BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), gp_Pnt(1, 1, 1)).Shape());
  builder.Add(pair, BRepPrimAPI_MakeBox(gp_Pnt(1, 0, 0), gp_Pnt(2, 1, 1)).Shape());
  const SewingReport report = Carried(Step(folder, pair), folder.File("out.step"));
  EXPECT_EQ(report.solids, 2u);
  EXPECT_EQ(report.shared_edges, 24u);
  EXPECT_EQ(report.free_edges, 0u);

  // Nor to surfaces of no body, where sewing is asked for.
  GeometryContents read = ReadGeometryContents(folder.File("in.brep"));
  read.geometry.push_back(Patch({Eigen::Vector3d(2, 0, 0), {3, 0, 0}, {2, 1, 0}, {3, 1, 0}}));
  const GeometryFile file{folder.File("more.step"), read.geometry, {}, read.bodies};
  const SewingReport more = WriteGeometry(file, {.sew = 1e-6}).value();
  EXPECT_EQ(more.surfaces, 13u);
  EXPECT_EQ(more.solids, 2u);
  EXPECT_EQ(more.loose, 1u);
}

TEST(SewingTest, AnOpenShellNamesItsFreeEdges) {
  const TemporaryFolder folder;
  std::vector<Geometry> sides = BoxSides({0, 0, 0}, {1, 1, 1});
  sides.pop_back();
  const GeometryFile file{folder.File("open.step"), sides};
  const SewingReport report = WriteGeometry(file, {.sew = 1e-6}).value();
  EXPECT_EQ(report.shells, 1u);
  EXPECT_EQ(report.free_edges, 4u);
  const GeometryContents back = ReadGeometryContents(file.path);
  ASSERT_EQ(back.bodies.size(), 1u);
  EXPECT_FALSE(back.bodies[0].watertight());
  ASSERT_EQ(back.bodies[0].free_edges.size(), 4u);
  for (const FreeEdge& edge : back.bodies[0].free_edges) {
    EXPECT_NEAR(edge.from[0], 1, 1e-9);  // the side at x = 1 is missing
    EXPECT_NEAR(edge.to[0], 1, 1e-9);
    EXPECT_NEAR((edge.from - edge.to).norm(), 1, 1e-9);
  }
  const GeometryContents metres = ReadGeometryContents(file.path, {.unit = "m"});
  EXPECT_NEAR(metres.bodies[0].tolerance / back.bodies[0].tolerance, 1e-3, 1e-12);
  EXPECT_NEAR(metres.bodies[0].free_edges[0].from[0], 1e-3, 1e-12);
  EXPECT_NEAR(metres.bodies[0].free_edges[0].to[0], 1e-3, 1e-12);
}

TEST(SewingTest, NamesOfSurfacesStayTheirs) {
  const TemporaryFolder folder;
  const GeometryFile file{folder.File("box.step"),
                          BoxSides({0, 0, 0}, {1, 2, 3}),
                          {"floor", "roof", "south", "north", "west", "east"}};
  WriteGeometry(file, {.sew = 1e-6});
  std::vector<std::string> names = ReadGeometryContents(file.path).names;
  std::sort(names.begin(), names.end());
  EXPECT_THAT(names, ElementsAre("east", "floor", "north", "roof", "south", "west"));
}

TEST(SewingTest, SewnFilesAreTheSameBytes) {
  const TemporaryFolder folder;
  const auto bytes = [&](const std::string& name) {
    WriteGeometry({folder.File(name), BoxSides({0, 0, 0}, {1, 2, 3})}, {.sew = 1e-6});
    return folder.Text(name);
  };
  EXPECT_EQ(bytes("a.step"), bytes("b.step"));
}

TEST(SewingTest, FormatsWithoutShellsRefuse) {
  const TemporaryFolder folder;
  for (const std::string name : {"a.json", "a.iges"}) {
    const GeometryFile file{folder.File(name), BoxSides({0, 0, 0}, {1, 1, 1})};
    EXPECT_THROW(WriteGeometry(file, {.sew = 0.1}), UsageError) << name;
    EXPECT_FALSE(WriteGeometry(file, {.sew = 0.0}).has_value());
  }
  const GeometryFile file{folder.File("a.step"), BoxSides({0, 0, 0}, {1, 1, 1})};
  EXPECT_THROW(WriteGeometry(file, {.sew = -1.0}), std::invalid_argument);
  GeometryFile wrong = file;
  wrong.bodies = {{.surfaces = {0, 6}}};
  EXPECT_THROW(WriteGeometry(wrong), std::invalid_argument);
  wrong.bodies = {{.surfaces = {0, 1}}, {.surfaces = {1, 2}}};
  EXPECT_THROW(WriteGeometry(wrong), std::invalid_argument);
}

}  // namespace batten::internal::sewing_test
