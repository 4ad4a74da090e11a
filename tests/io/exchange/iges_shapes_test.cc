// SPDX-License-Identifier: MIT
// Curves and surfaces that other programs write to IGES besides B-splines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <GProp_GProps.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <TopExp_Explorer.hxx>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <gp_Elips.hxx>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "angles.h"
#include "batten/geometry/arc_length.h"
#include "batten/geometry/surface_area.h"
#include "batten/io/geometry_file.h"
#include "batten/io/iges_reader.h"
#include "batten/io/read_error.h"
#include "temporary_folder.h"

namespace batten::internal::iges_shapes_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// An entity: its type, form, and parameters after the type; `dependent`: a part of another.
struct Record {
  int type, form;
  std::string parameters;
  bool dependent = false;
};

// A file of such entities, the k-th of which pointers call 2k + 1, in millimetres.
std::string IgesText(const std::vector<Record>& records) {
  std::string directory, parameters;
  int line = 1, entry = 1;
  const auto row = [](const std::string& data, char section, int number) {
    char text[100];
    std::snprintf(text, sizeof text, "%-72s%c%7d\n", data.c_str(), section, number);
    return std::string(text);
  };
  for (const Record& record : records) {
    const std::string data = std::to_string(record.type) + "," + record.parameters + ";";
    const int first = line;
    for (size_t at = 0; at < data.size(); at += 64) {
      std::string part = data.substr(at, 64);
      part.resize(64, ' ');
      char pointer[16];
      std::snprintf(pointer, sizeof pointer, "%8d", entry);
      parameters += row(part + pointer, 'P', line++);
    }
    char text[100];
    std::snprintf(text,
                  sizeof text,
                  "%8d%8d%8d%8d%8d%8d%8d%8d%s",
                  record.type,
                  first,
                  0,
                  0,
                  0,
                  0,
                  0,
                  0,
                  record.dependent ? "00010000" : "00000000");
    directory += row(text, 'D', entry);
    std::snprintf(
        text, sizeof text, "%8d%8d%8d%8d%8d", record.type, 0, 0, line - first, record.form);
    directory += row(text, 'D', entry + 1);
    entry += 2;
  }
  return row("", 'S', 1) + row("1H,,1H;,,,,,32,308,15,308,15,,1.,2,2HMM;", 'G', 1) + directory +
         parameters + row("S1G1D1P1", 'T', 1);
}

class IgesShapesTest : public testing::Test {
 protected:
  std::vector<Geometry> Read(const std::vector<Record>& records) {
    return ReadIges(folder_.With("a.igs", IgesText(records)));
  }
  NurbsCurve<3> Curve(const Record& record) {
    return std::get<NurbsCurve<3>>(Read({record}).at(0));
  }

  TemporaryFolder folder_;
};

TEST_F(IgesShapesTest, ArcsRunCounterClockwiseAtTheirHeight) {
  // Centre (1, 2), from (4, 2) to (1, 5), at height 7.
  const NurbsCurve<3> arc = Curve({100, 0, "7.,1.,2.,4.,2.,1.,5."});
  EXPECT_LT((arc.At(0) - Eigen::Vector3d(4, 2, 7)).norm(), 1e-14);
  EXPECT_LT((arc.At(1) - Eigen::Vector3d(1, 5, 7)).norm(), 1e-14);
  EXPECT_NEAR(ArcLength(arc), 3 * kPi / 2, 1e-12);
  // The same end: all round.
  EXPECT_NEAR(ArcLength(Curve({100, 0, "0.,1.,2.,4.,2.,4.,2."})), 6 * kPi, 1e-11);
  EXPECT_NEAR(ArcLength(Curve({100, 0, "0.,0.,0.,0.,1.,1.,0."})), 1.5 * kPi, 1e-11);
}

TEST_F(IgesShapesTest, EllipsesAreThoseOfTheirEquation) {
  // x²/9 + y²/4 = 1 from (3, 0) to (0, 2).
  const NurbsCurve<3> arc = Curve({104, 1, "4.,0.,9.,0.,0.,-36.,1.,3.,0.,0.,2."});
  for (const double u : {0.0, 0.2, 0.5, 1.0}) {
    const Eigen::Vector3d p = arc.At(u);
    EXPECT_NEAR(p.x() * p.x() / 9 + p.y() * p.y() / 4, 1, 1e-14);
    EXPECT_EQ(p.z(), 1);
  }
  EXPECT_LT((arc.At(1) - Eigen::Vector3d(0, 2, 1)).norm(), 1e-14);
  EXPECT_THROW(Curve({104, 3, "1.,0.,0.,0.,-1.,0.,0.,-1.,1.,1.,1."}), ReadError);
}

TEST_F(IgesShapesTest, PolylinesGoThroughTheirPoints) {
  const NurbsCurve<3> flat = Curve({106, 11, "1,3,5.,0.,0.,3.,4.,3.,10."});
  EXPECT_EQ(flat.basis().degree(), 1);
  EXPECT_TRUE(flat.control_points() ==
              (Eigen::Matrix3d() << 0, 3, 3, 0, 4, 10, 5, 5, 5).finished());
  const NurbsCurve<3> space = Curve({106, 12, "2,2,1.,2.,3.,4.,5.,6."});
  EXPECT_TRUE(space.control_points().col(1) == Eigen::Vector3d(4, 5, 6));
  EXPECT_THROW(Curve({106, 12, "2,2000000,1.,2.,3.,4.,5.,6."}), ReadError);
  // Form 2 are points, which are left out.
  const std::string path = folder_.With(
      "p.igs", IgesText({{106, 2, "2,2,1.,2.,3.,4.,5.,6."}, {110, 0, "0.,0.,0.,1.,0.,0."}}));
  const GeometryContents contents = ReadIgesContents(path);
  EXPECT_EQ(contents.geometry.size(), 1u);
  EXPECT_THAT(
      contents.remarks,
      ElementsAre("its 1 points are left out", "it holds only lines: they are curves of degree 1"));
}

TEST_F(IgesShapesTest, ParametricSplinesAreTheirPolynomials) {
  // x = s, y = s³ − s on [0, 2], then its continuation on [2, 3]; z = 1 − s².
  const NurbsCurve<3> curve = Curve({112,
                                     0,
                                     "3,1,3,2,0.,2.,3.,"
                                     "0.,1.,0.,0.,0.,-1.,0.,1.,1.,0.,-1.,0.,"
                                     "2.,1.,0.,0.,6.,11.,6.,1.,-3.,-4.,-1.,0.,"
                                     "0.,0.,0.,0.,0.,0.,0.,0.,0.,0.,0.,0."});
  for (const double s : {0.0, 0.7, 2.0, 2.6, 3.0}) {
    EXPECT_LT((curve.At(s) - Eigen::Vector3d(s, s * s * s - s, 1 - s * s)).norm(), 1e-12) << s;
  }
  EXPECT_EQ(curve.basis().size(), 5) << "the break is smooth: one knot is left of three at most";
}

TEST_F(IgesShapesTest, RuledAndTabulatedSurfacesSpanTheirCurves) {
  const Record arc{100, 0, "0.,0.,0.,1.,0.,0.,1.", true};
  const Record line{110, 0, "2.,0.,3.,0.,2.,3.", true};
  const auto ruled = Read({arc, line, {118, 1, "1,3,0,0"}});
  ASSERT_EQ(ruled.size(), 1u);
  const auto& surface = std::get<NurbsSurface>(ruled[0]);
  EXPECT_LT((surface.At(0, 0) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-14);
  EXPECT_LT((surface.At(1, 1) - Eigen::Vector3d(0, 2, 3)).norm(), 1e-14);
  // On the line between the middles, wherever on it: only one of the curves is rational.
  const Eigen::Vector3d from(std::sqrt(0.5), std::sqrt(0.5), 0), to(1, 1, 3);
  const Eigen::Vector3d middle = surface.At(0.5, 0.5) - from;
  EXPECT_LT(middle.cross((to - from).normalized()).norm(), 1e-14);
  const auto turned = Read({arc, line, {118, 1, "1,3,1,0"}});
  EXPECT_LT((std::get<NurbsSurface>(turned.at(0)).At(0, 1) - Eigen::Vector3d(0, 2, 3)).norm(),
            1e-14);
  const auto tabulated = Read({arc, {122, 0, "1,1.,0.,5."}});
  EXPECT_NEAR(Area(std::get<NurbsSurface>(tabulated.at(0))), 5 * kPi / 2, 1e-9);
}

TEST_F(IgesShapesTest, RevolutionsTurnAboutTheirAxis) {
  const Record axis{110, 0, "0.,0.,0.,0.,0.,1.", true};
  const Record profile{110, 0, "2.,0.,0.,2.,0.,3.", true};
  const auto tube = Read({axis, profile, {120, 0, "1,3,0.,3.14159265358979"}});
  EXPECT_NEAR(Area(std::get<NurbsSurface>(tube.at(0))), 6 * kPi, 1e-9);
  // A quarter of it, 0 < z < 1 and 0 < angle < π/2, cut out by a loop in (z, angle), first z.
  const std::string half = "1.5707963267949";
  const auto cut = Read({axis,
                         profile,
                         {120, 0, "1,3,0.,3.14159265358979", true},
                         {106,
                          63,
                          "1,5,0.,0.,0.,0.33333333333333333,0.,0.33333333333333333," + half +
                              ",0.," + half + ",0.,0.",
                          true},
                         {142, 0, "1,5,7,0,1", true},
                         {144, 0, "5,1,0,9"}});
  ASSERT_EQ(cut.size(), 1u);
  const auto& patch = std::get<NurbsSurface>(cut[0]);
  EXPECT_EQ(patch.trims().size(), 1u);
  EXPECT_NEAR(Area(patch), kPi, 1e-6);
}

TEST_F(IgesShapesTest, WhatIsNotReadIsNamed) {
  const auto refusal = [&](const std::vector<Record>& records) -> std::string {
    try {
      Read(records);
    } catch (const ReadError& error) {
      return error.what();
    }
    return "(read)";
  };
  EXPECT_THAT(refusal({{116, 0, "1.,2.,3."}, {116, 0, "1.,2.,4."}}),
              HasSubstr("holds no curves or surfaces that can be read, 2 points only"));
  EXPECT_THAT(refusal({{408, 0, "1,0.,0.,0.,1."}}), HasSubstr("places a subfigure"));
  for (const int array : {412, 414, 420}) {
    EXPECT_THAT(refusal({{array, 0, "1,0.,0.,0.,1."}}), HasSubstr("places a subfigure"));
  }
  EXPECT_THAT(refusal({{416, 0, "5Hother"}}), HasSubstr("in another file"));
  for (const int solid : {184, 430}) {
    EXPECT_THAT(refusal({{116, 0, "1.,2.,3."}, {solid, 1, "1,1,1"}}),
                HasSubstr("entity D3 (type " + std::to_string(solid) + "): is of a B-rep solid"));
  }
  // What OpenCASCADE would follow blindly is named before.
  const std::vector<std::tuple<int, const char*, const char*>> damaged = {
      {186, "1,1,0", "names no shell"},
      {514, "1,1,1", "names no face"},
      {514, "0", "names no face"},
      {510, "1,1,1,1", "names no surface"},
      {508, "1,0,1,1,1,0", "names no edge"},
      {504, "1,1,1,1,1,1", "names no curve of an edge"},
      {502, "4,1.,1.,1.", "promises more numbers than it has"}};
  for (const auto& [type, numbers, why] : damaged) {
    const std::string known = "entity D3 (type " + std::to_string(type) + "): ";
    EXPECT_THAT(refusal({{116, 0, "1.,2.,3."}, {type, 1, numbers}}),
                ::testing::AllOf(HasSubstr(known), HasSubstr(why)));
  }
  EXPECT_THAT(refusal({{123, 1, "1.,0.,0."}, {504, 1, "1,1,1,1,1,1"}}),
              HasSubstr("names no curve of an edge"));  // but a direction
  EXPECT_THAT(refusal({{114, 0, "1,1,1,1"}}), HasSubstr("type that can't be read"));
  EXPECT_THAT(refusal({{120, 0, "1,1,0.,1."}}), HasSubstr("entity D1 (type 120)"));
}

TEST_F(IgesShapesTest, WhatIsLeftOutOfASolidIsSaid) {
  const std::string path = folder_.With(
      "b.igs", IgesText({{110, 0, "0.,0.,0.,1.,0.,0."}, {186, 0, "5,1,0"}, {514, 1, "1,7,1"}}));
  const GeometryContents contents = ReadIgesContents(path);
  EXPECT_EQ(contents.geometry.size(), 1u);
  ASSERT_EQ(contents.unread.size(), 1u);
  EXPECT_THAT(contents.unread[0], HasSubstr("(type 514): names no face of the file"));
}

// What OpenCASCADE writes of solids of revolution, face by face, has their area.
TEST_F(IgesShapesTest, FacesOfAnotherWriterHaveItsAreas) {
  const std::vector<std::pair<const char*, TopoDS_Shape>> solids = {
      {"cylinder", BRepPrimAPI_MakeCylinder(2, 5).Shape()},
      {"sector", BRepPrimAPI_MakeCylinder(2, 5, 1.2).Shape()},
      {"cone", BRepPrimAPI_MakeCone(3, 1, 4).Shape()},
      {"sphere", BRepPrimAPI_MakeSphere(2).Shape()},
      {"torus", BRepPrimAPI_MakeTorus(5, 1).Shape()}};
  for (const auto& [name, solid] : solids) {
    SCOPED_TRACE(name);
    IGESControl_Controller::Init();
    IGESControl_Writer writer("MM", 0);
    ASSERT_TRUE(writer.AddShape(solid));
    writer.ComputeModel();
    ASSERT_TRUE(writer.Write(folder_.File("solid.igs").c_str()));
    GProp_GProps properties;
    BRepGProp::SurfaceProperties(solid, properties, 1e-9);
    double area = 0;
    const std::vector<Geometry> faces = ReadIges(folder_.File("solid.igs"));
    for (const Geometry& face : faces) area += Area(std::get<NurbsSurface>(face));
    int count = 0;
    for (TopExp_Explorer all(solid, TopAbs_FACE); all.More(); all.Next()) ++count;
    EXPECT_EQ(static_cast<int>(faces.size()), count);
    EXPECT_NEAR(area, properties.Mass(), 1e-5 * properties.Mass());
  }
}

}  // namespace batten::internal::iges_shapes_test
