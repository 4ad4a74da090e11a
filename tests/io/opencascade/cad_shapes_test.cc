// SPDX-License-Identifier: MIT
// Bodies of CAD files are written again as they were read, and a face that can't be read costs no
// other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepGProp.hxx>
#include <BRepLib.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <GCE2d_MakeSegment.hxx>
#include <GProp_GProps.hxx>
#include <GeomAPI_PointsToBSpline.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>

#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "batten/geometry/surface_area.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "temporary_folder.h"

namespace batten::internal::cad_shapes_test {

using ::testing::HasSubstr;

// Integrals over the same faces with other curves in their parameters.
constexpr double kSameVolume = 1e-9;

// A drilled block with a rounded edge: planes, cylinders, seams, trims.
TopoDS_Shape Block(double x) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(gp_Pnt(x, 0, 0), 40, 30, 10).Shape();
  BRepFilletAPI_MakeFillet fillet(box);
  fillet.Add(3, TopoDS::Edge(TopExp_Explorer(box, TopAbs_EDGE).Current()));
  return BRepAlgoAPI_Cut(
             fillet.Shape(),
             BRepPrimAPI_MakeCylinder(gp_Ax2({x + 20, 15, -5}, {0, 0, 1}), 5, 30).Shape())
      .Shape();
}

TopoDS_Shape Together(const std::vector<TopoDS_Shape>& shapes) {
  TopoDS_Compound all;
  const BRep_Builder builder;
  builder.MakeCompound(all);
  for (const TopoDS_Shape& shape : shapes) builder.Add(all, shape);
  return all;
}

std::string SavedBrep(const TemporaryFolder& folder, const TopoDS_Shape& shape) {
  const std::string path = folder.File("given.brep");
  BRepTools::Write(shape, path.c_str());
  return path;
}

std::string SavedIges(const TemporaryFolder& folder, const TopoDS_Shape& shape) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  IGESControl_Controller::Init();
  IGESControl_Writer writer("IN", 1);  // solids, not trimmed surfaces
  writer.AddShape(shape);
  writer.ComputeModel();
  const std::string path = folder.File("given.igs");
  writer.Write(path.c_str());
  return path;
}

// How many faces are of each kind.
std::map<int, int> KindsIn(const std::string& brep) {
  TopoDS_Shape shape;
  BRepTools::Read(shape, brep.c_str(), BRep_Builder());
  EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
  std::map<int, int> kinds;
  for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next())
    ++kinds[BRepAdaptor_Surface(TopoDS::Face(faces.Current())).GetType()];
  return kinds;
}

double VolumeOf(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, 1e-10);
  return properties.Mass();
}

GeometryFile Unchanged(const std::string& path, const GeometryContents& read) {
  return {path, read.geometry, read.names, read.bodies, read.shapes};
}

TEST(CadShapesTest, BodiesAreWrittenAsTheyWereRead) {
  const TemporaryFolder folder;
  const TopoDS_Shape parts = Together({Block(0), Block(100)});
  const double volume = VolumeOf(parts) / 2;
  const std::string given = SavedBrep(folder, parts);
  for (const std::string& from : {given, SavedIges(folder, parts)}) {
    SCOPED_TRACE(from);
    const GeometryContents read = ReadGeometryContents(from);
    ASSERT_EQ(read.bodies.size(), 2u);
    EXPECT_TRUE(read.unread.empty());
    const double inch = read.unit == "inch" ? 25.4 : 1;
    for (const BodyMeasures& one : MeasureBodies(read))
      EXPECT_NEAR(one.volume * inch * inch * inch, volume, 1e-6 * volume);
    std::string path = folder.File("a.step");
    WriteGeometry(Unchanged(path, read), {.unit = read.unit.empty() ? "mm" : read.unit});
    const GeometryContents step = ReadGeometryContents(path, {.unit = "mm"});
    path = folder.File("b.brep");
    const auto report = WriteGeometry(Unchanged(path, step));
    ASSERT_TRUE(report);
    EXPECT_EQ(report->solids, 2u);
    EXPECT_TRUE(report->watertight());
    const GeometryContents brep = ReadGeometryContents(path);
    EXPECT_EQ(brep.geometry.size(), read.geometry.size());
    const std::vector<BodyMeasures> measures = MeasureBodies(brep);
    ASSERT_EQ(measures.size(), 2u);
    for (const BodyMeasures& one : measures) EXPECT_NEAR(one.volume, volume, 1e-6 * volume);
    EXPECT_NEAR((measures[1].center - measures[0].center).norm(), 100, 1e-6);
    if (from == given) {
      EXPECT_EQ(KindsIn(path), KindsIn(given));
    }
  }
}

TEST(CadShapesTest, MeasuresFollowTheUnit) {
  const TemporaryFolder folder;
  const std::string given = SavedBrep(folder, Block(7));
  const BodyMeasures metres = MeasureBodies(ReadGeometryContents(given))[0];
  const GeometryContents read = ReadGeometryContents(given, {.unit = "mm", .undeclared = "m"});
  const BodyMeasures scaled = MeasureBodies(read)[0];
  EXPECT_NEAR(scaled.volume, 1e9 * metres.volume, kSameVolume * scaled.volume);
  EXPECT_NEAR(scaled.area, 1e6 * metres.area, kSameVolume * scaled.area);
  EXPECT_LE((scaled.center - 1e3 * metres.center).norm(), kSameVolume * scaled.center.norm());
  EXPECT_LE((scaled.inertia - 1e15 * metres.inertia).norm(), kSameVolume * scaled.inertia.norm());
  WriteGeometry(Unchanged(folder.File("a.step"), read));
  const auto written = MeasureBodies(ReadGeometryContents(folder.File("a.step")));
  ASSERT_EQ(written.size(), 1u);
  EXPECT_NEAR(written[0].volume, scaled.volume, kSameVolume * scaled.volume);
}

// The inertia of a block about its center, at density 1.
TEST(CadShapesTest, ABlockHasItsInertia) {
  const TemporaryFolder folder;
  const std::string given = SavedBrep(folder, BRepPrimAPI_MakeBox(2, 3, 4).Shape());
  const BodyMeasures block = MeasureBodies(ReadGeometryContents(given))[0];
  const double mass = 24;
  const Eigen::Vector3d diagonal = mass / 12 * Eigen::Vector3d(9 + 16, 4 + 16, 4 + 9);
  EXPECT_NEAR(block.area, 52, 1e-9);
  EXPECT_LE((block.center - Eigen::Vector3d(1, 1.5, 2)).norm(), 1e-9);
  EXPECT_LE((block.inertia - Eigen::Matrix3d(diagonal.asDiagonal())).norm(), 1e-6);
}

TEST(CadShapesTest, ABodyThatLooksInwardsHasItsVolumeAndIsTold) {
  const TemporaryFolder folder;
  const TopoDS_Shape block = BRepPrimAPI_MakeBox(2, 3, 4).Shape();
  const BodyMeasures usual = MeasureBodies(ReadGeometryContents(SavedBrep(folder, block)))[0];
  const BodyMeasures turned =
      MeasureBodies(ReadGeometryContents(SavedBrep(folder, block.Reversed())))[0];
  EXPECT_FALSE(usual.inside_out);
  EXPECT_TRUE(turned.inside_out);
  EXPECT_NEAR(turned.volume, 24, 1e-9);
  EXPECT_LE((turned.inertia - usual.inertia).norm(), 1e-9);
}

// OpenCASCADE makes no face of a cylinder whose radius is negative, and says nothing.
TEST(CadShapesTest, FacesThatOpenCascadeDropsAreAmongTheUnread) {
  const TemporaryFolder folder;
  const GeometryContents whole = ReadGeometryContents(SavedBrep(folder, Block(0)));
  const std::string path = folder.File("a.step");
  WriteGeometry(Unchanged(path, whole), {.unit = "mm"});
  std::ifstream file(path, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(file), {});
  const size_t cylinder = text.find("CYLINDRICAL_SURFACE('',");
  ASSERT_NE(cylinder, text.npos);
  const size_t radius = text.find(',', text.find(',', cylinder) + 1) + 1;
  text.insert(radius, "-");
  std::ofstream(path, std::ios::binary) << text;
  const GeometryContents read = ReadGeometryContents(path);
  EXPECT_EQ(read.geometry.size() + 1, whole.geometry.size());
  ASSERT_EQ(read.unread.size(), 1u);
  EXPECT_THAT(read.unread[0], HasSubstr("OpenCASCADE makes no face of it"));
  EXPECT_FALSE(read.shapes.whole);
  EXPECT_THROW(ReadGeometry(path), ReadError);
}

// A vase with a hole through its wall: a turned spline, whose angle no NURBS has for a parameter.
TEST(CadShapesTest, TrimsOfSurfacesWithOtherParametersAreBroughtToThoseOfNurbs) {
  const TemporaryFolder folder;
  TColgp_Array1OfPnt profile(1, 5);
  const double radii[] = {3, 4, 3, 2.5, 3.5};
  for (int k = 1; k <= 5; ++k) profile.SetValue(k, gp_Pnt(radii[k - 1], 0, 2 * k));
  const TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(GeomAPI_PointsToBSpline(profile).Curve());
  const TopoDS_Shape vase = BRepPrimAPI_MakeRevol(edge, gp_Ax1({0, 0, 0}, {0, 0, 1})).Shape();
  const TopoDS_Shape drilled =
      BRepAlgoAPI_Cut(vase, BRepPrimAPI_MakeCylinder(gp_Ax2({0, 0, 6}, {1, 1, 0}), 1, 9).Shape())
          .Shape();
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(drilled, properties, 1e-9);
  const GeometryContents read = ReadGeometryContents(SavedBrep(folder, drilled));
  ASSERT_TRUE(read.unread.empty()) << read.unread[0];
  double area = 0;
  for (const Geometry& one : read.geometry) area += Area(std::get<NurbsSurface>(one));
  EXPECT_NEAR(area, properties.Mass(), 1e-5 * properties.Mass());
}

// A band that winds round its cylinder ten million times, beside a block.
TEST(CadShapesTest, AFaceThatCantBeReadCostsNoOther) {
  const Handle(Geom_Surface) surface = new Geom_CylindricalSurface(gp_Ax3(), 2);
  const double turns = 1e7, far = 2 * std::numbers::pi * turns;
  const std::vector<gp_Pnt2d> corners = {{0, 1}, {far, 1 + turns}, {far, 1.5 + turns}, {0, 1.5}};
  BRepBuilderAPI_MakeWire wire;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    wire.Add(BRepBuilderAPI_MakeEdge(GCE2d_MakeSegment(corners[k], corners[(k + 1) % 4]).Value(),
                                     surface));
  }
  const TopoDS_Face band = BRepBuilderAPI_MakeFace(surface, wire);
  BRepLib::BuildCurves3d(band);
  const TemporaryFolder folder;
  const std::string given =
      SavedBrep(folder, Together({BRepPrimAPI_MakeBox(1, 2, 3).Shape(), band}));
  const GeometryContents read = ReadGeometryContents(given);
  EXPECT_EQ(read.geometry.size(), 6u);
  ASSERT_EQ(read.unread.size(), 1u);
  EXPECT_THAT(read.unread[0], HasSubstr("face 7"));
  EXPECT_THROW(ReadGeometryContents(given, {.strict = true}), ReadError);
  EXPECT_THROW(ReadGeometry(given), ReadError);
  WriteGeometry(Unchanged(folder.File("b.brep"), read));
  EXPECT_EQ(ReadGeometryContents(folder.File("b.brep")).unread, read.unread);
}

}  // namespace batten::internal::cad_shapes_test
