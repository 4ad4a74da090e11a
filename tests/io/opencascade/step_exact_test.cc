// SPDX-License-Identifier: MIT
// Exact shapes in STEP: the analytic entities, valid faces, and the same NURBS back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Tool.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "batten/geometry/exact_shape.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/reverse.h"
#include "batten/io/step_reader.h"
#include "batten/io/step_writer.h"
#include "random_splines.h"
#include "temporary_folder.h"
#include "angles.h"

namespace batten::internal::step_exact_test {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr unsigned kSeed = 81;
constexpr double kStepPrecision = 1e-12;  // relative, as for free-form shapes

TopoDS_Shape Oracle(const std::string& path) {
  STEPControl_Reader reader;
  EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
  reader.TransferRoots();
  return reader.OneShape();
}

int Count(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  int count = 0;
  for (TopExp_Explorer parts(shape, kind); parts.More(); parts.Next()) ++count;
  return count;
}

int Degenerated(const TopoDS_Shape& shape) {
  int count = 0;
  for (TopExp_Explorer edges(shape, TopAbs_EDGE); edges.More(); edges.Next()) {
    count += BRep_Tool::Degenerated(TopoDS::Edge(edges.Current()));
  }
  return count;
}

struct Written {
  std::string text;
  TopoDS_Shape shape;
  Geometry back;
};

Written WriteAndRead(const Geometry& geometry) {
  const TemporaryFolder folder;
  WriteStep({geometry}, folder.File("a.step"));
  const std::vector<Geometry> back = ReadStep(folder.File("a.step"));
  EXPECT_EQ(back.size(), 1u);
  return {folder.Text("a.step"), Oracle(folder.File("a.step")), back.at(0)};
}

double Largest(const NurbsSurface& surface) {
  return surface.control_points().cwiseAbs().maxCoeff();
}

// Control points, weights and knots came back to rounding.
void ExpectSame(const NurbsSurface& got, const NurbsSurface& expected) {
  ASSERT_EQ(got.size_u(), expected.size_u());
  ASSERT_EQ(got.size_v(), expected.size_v());
  const auto knots = [](const SplineBasis& basis) {
    return Eigen::Map<const Eigen::VectorXd>(basis.knots().data(), basis.size()).eval();
  };
  EXPECT_TRUE(knots(got.basis_u()).isApprox(knots(expected.basis_u()), 1e-15));
  EXPECT_TRUE(knots(got.basis_v()).isApprox(knots(expected.basis_v()), 1e-15));
  EXPECT_LE((got.control_points() - expected.control_points()).cwiseAbs().maxCoeff(),
            kStepPrecision * Largest(expected));
  // Angles, and weights with them, are what the coordinates of the boundary tell.
  const Eigen::Matrix3Xd& p = expected.control_points();
  const double size = (p.rowwise().maxCoeff() - p.rowwise().minCoeff()).norm();
  EXPECT_LE((got.weights() - expected.weights()).cwiseAbs().maxCoeff(),
            kStepPrecision * std::max(1.0, Largest(expected) / size));
}

AngleRange Angles(RandomSplines& random) {
  return {random.Coin() ? 0 : random.Real(-3, 7),
          random.Coin() ? 2 * kPi : random.Real(0.2, 2 * kPi)};
}

struct Kind {
  const char* entity;
  ExactSurface shape;
  int degenerated = 0;
  bool reversed = false;  // comes back with u and v reversed
};

Kind Any(int kind, RandomSplines& random, double far) {
  const Frame frame(random.Vector(far), random.Vector(1), random.Vector(1));
  const double r = random.Logarithmic(0.1, 100);
  const Interval height{r * random.Real(-2, 0), r * random.Real(0.1, 3)};
  const bool tip = random.Coin(), south = random.Coin(), north = random.Coin();
  const double other = tip ? 0 : r * random.Real(0.1, 0.9);
  switch (kind) {
    case 0:
      return {"PLANE(", ExactPlane{frame, height, {-r, 2 * r}}};
    case 1:
      return {"CYLINDRICAL_SURFACE(", ExactCylinder{frame, r, height, Angles(random)}};
    case 2:
      return {"CONICAL_SURFACE(", ExactCone{frame, other, r, height, Angles(random)}, tip};
    case 3:
      return {"CONICAL_SURFACE(", ExactCone{frame, r, other, height, Angles(random)}, tip, true};
    case 4:
      return {"SPHERICAL_SURFACE(",
              ExactSphere{frame,
                          r,
                          Angles(random),
                          {south ? -kPi / 2 : random.Real(-1.5, -0.1),
                           north ? kPi / 2 : random.Real(0.1, 1.5)}},
              south + north};
    default:
      AngleRange tube = Angles(random);
      if (tube.full()) tube.start = 0;
      return {"TOROIDAL_SURFACE(",
              ExactTorus{frame, r, r * random.Real(0.05, 0.9), Angles(random), tube}};
  }
}

void ExpectAnalytic(const Kind& kind) {
  const NurbsSurface made = ToNurbs(kind.shape);
  const Written written = WriteAndRead(made);
  EXPECT_THAT(written.text, HasSubstr(kind.entity));
  EXPECT_THAT(written.text, Not(HasSubstr("B_SPLINE_SURFACE")));
  EXPECT_TRUE(BRepCheck_Analyzer(written.shape).IsValid());
  EXPECT_EQ(Count(written.shape, TopAbs_FACE), 1);
  EXPECT_EQ(Count(written.shape, TopAbs_WIRE), 1);
  EXPECT_EQ(Count(written.shape, TopAbs_EDGE), 4);  // a seam counts on both sides
  EXPECT_EQ(Degenerated(written.shape), kind.degenerated);
  const NurbsSurface& back = std::get<NurbsSurface>(written.back);
  ExpectSame(back, kind.reversed ? Reversed(Reversed(made, Direction::kU), Direction::kV) : made);
}

TEST(StepExactTest, PrimitivesAreAnalyticValidAndComeBack) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 120; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", case " << k);
    ExpectAnalytic(Any(k % 6, random, k % 2 == 0 ? 0 : 100));
  }
}

TEST(StepExactTest, PartsFarAwayAreTheSameToTheirCoordinatesRounding) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 24; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", case " << k);
    const NurbsSurface made = ToNurbs(Any(k % 6, random, 5e6).shape);
    const Written written = WriteAndRead(made);
    EXPECT_TRUE(BRepCheck_Analyzer(written.shape).IsValid());
    const NurbsSurface& back = std::get<NurbsSurface>(written.back);
    // A cone that narrows comes back reversed where it is analytic.
    const bool turned = k % 6 == 3 && written.text.find("CONICAL_SURFACE") != std::string::npos;
    ExpectSame(back, turned ? Reversed(Reversed(made, Direction::kU), Direction::kV) : made);
  }
}

TEST(StepExactTest, LinesAndCirclesAreAnalyticToo) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 20; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", case " << k);
    const Frame frame(random.Vector(100), random.Vector(1), random.Vector(1));
    const NurbsCurve<3> arc = MakeArc(frame, random.Logarithmic(0.1, 100), Angles(random));
    const NurbsCurve<3> line = MakeLine<3>(random.Vector(5), random.Vector(5));
    for (const NurbsCurve<3>& curve : {arc, line}) {
      const Written written = WriteAndRead(curve);
      EXPECT_THAT(written.text, HasSubstr(&curve == &line ? "LINE(" : ""));
      EXPECT_THAT(written.text, Not(HasSubstr("B_SPLINE_CURVE")));
      EXPECT_TRUE(BRepCheck_Analyzer(written.shape).IsValid());
      const auto& back = std::get<NurbsCurve<3>>(written.back);
      EXPECT_EQ(back.basis(), curve.basis());
      EXPECT_LE((back.control_points() - curve.control_points()).cwiseAbs().maxCoeff(),
                kStepPrecision * curve.control_points().cwiseAbs().maxCoeff());
    }
  }
  const Written plane = WriteAndRead(MakeArc(Eigen::Vector2d(1, 2), 3, {0.3, 4}));
  EXPECT_THAT(plane.text, HasSubstr("CIRCLE("));
}

// What OpenCASCADE does not read back as it was stays free-form, and valid.
TEST(StepExactTest, WhatReadersWouldLoseIsWrittenAsSplines) {
  const AngleRange part{1, 2}, whole{1, 2 * kPi};
  const std::vector<NurbsSurface> shapes = {
      MakeTorus(Frame(), 2, 1, part, whole),
      MakeTorus(Frame(), 1, 2, part, {-1, 2}),
      MakeCone(Frame({5e6, 5e6, 0}, {1, 2, 3}), 0, 1, {0, 2}, part),
  };
  for (const NurbsSurface& shape : shapes) {
    const Written written = WriteAndRead(shape);
    EXPECT_THAT(written.text, HasSubstr("B_SPLINE_SURFACE"));
    EXPECT_TRUE(BRepCheck_Analyzer(written.shape).IsValid());
    ExpectSame(std::get<NurbsSurface>(written.back), shape);
  }
}

// Nothing but what batten makes itself becomes analytic: other parameters would be lost.
TEST(StepExactTest, FreeFormShapesStayAsTheyAre) {
  const NurbsSurface cylinder = MakeCylinder(Frame(), 1, {0, 2});
  const NurbsSurface inside_out = Reversed(cylinder, Direction::kV);
  const Written written = WriteAndRead(inside_out);
  EXPECT_THAT(written.text, HasSubstr("B_SPLINE_SURFACE"));
  ExpectSame(std::get<NurbsSurface>(written.back), inside_out);
}

}  // namespace batten::internal::step_exact_test
