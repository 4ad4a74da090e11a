// SPDX-License-Identifier: MIT
// Periodic surfaces and poles in files: readers see closed surfaces.
#include <gtest/gtest.h>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Tool.hxx>
#include <Geom_BSplineSurface.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "batten/geometry/closure.h"
#include "batten/io/geometry_file.h"
#include "batten/io/step_reader.h"
#include "batten/io/step_writer.h"
#include "random_splines.h"
#include "temporary_folder.h"

namespace batten::internal::step_closed_test {

constexpr unsigned kSeed = 82;
constexpr double kStepPrecision = 1e-12;

SplineBasis RoundBasis(int degree, int spans) {
  std::vector<double> knots;
  for (int i = -degree; i <= spans + degree; ++i) knots.push_back(i);
  return SplineBasis::Periodic(degree, std::move(knots));
}

enum class Form { kTube, kTorus, kBall };

// A lumpy closed shape, periodic round the axis; the ball's ends in v are points.
NurbsSurface Lumpy(Form form, int degree, RandomSplines& random, double far) {
  const int around = random.Integer(degree + 4, 12), along = random.Integer(degree + 4, 10);
  const SplineBasis bu = RoundBasis(degree, around);
  const SplineBasis bv =
      form == Form::kTorus ? RoundBasis(degree, along) : SplineBasis::Uniform(degree, along, -1, 2);
  const Eigen::Vector3d center = random.Vector(far);
  Eigen::Matrix3Xd points(3, bu.size() * bv.size());
  constexpr double kPi = std::numbers::pi;
  for (int i = 0; i < bu.size(); ++i) {
    for (int j = 0; j < bv.size(); ++j) {
      const double turn = 2 * kPi * (i % around) / around;
      const double v = form == Form::kTorus ? 2 * kPi * (j % along) / along
                                            : kPi * (j / (bv.size() - 1.0) - 0.5);
      const bool pole = form == Form::kBall && (j == 0 || j == bv.size() - 1);
      const double lump = 1 + 0.05 * std::sin(3 * turn + 2 * v);
      const double r = pole                   ? 0
                       : form == Form::kTorus ? 3 + lump * std::cos(v)
                       : form == Form::kTube  ? 2 * lump
                                              : 2 * lump * std::cos(v);
      const double z = form == Form::kTube ? 2 * v : 2 * std::sin(v);
      points.col(i * bv.size() + j) =
          center + Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), z);
    }
  }
  return NurbsSurface(bu, bv, std::move(points));
}

double WorstGap(const NurbsSurface& a, const NurbsSurface& b) {
  double worst = 0;
  const auto at = [](const SplineBasis& basis, double t) {
    return basis.lower() + t * (basis.upper() - basis.lower());
  };
  for (double s = 0; s <= 1; s += 1 / 37.0) {
    for (double t = 0; t <= 1; t += 1 / 41.0) {
      const double u = at(a.basis_u(), s), v = at(a.basis_v(), t);
      worst = std::max(worst, (a.At(u, v) - b.At(u, v)).norm());
    }
  }
  return worst;
}

// The flags u_closed, v_closed and self_intersect follow the surface's form.
std::string ClosedFlags(std::string text) {
  text.erase(std::remove_if(text.begin(), text.end(), [](char c) { return c == ' ' || c == '\n'; }),
             text.end());
  const size_t surface = text.find("B_SPLINE_SURFACE");
  const size_t form = text.find(".UNSPECIFIED.,", surface);
  return form == std::string::npos ? "" : text.substr(form + 14, 8);
}

struct Topology {
  bool valid;
  int faces = 0, wires = 0, edges = 0, seams = 0, degenerated = 0;
};

Topology TopologyOf(const std::string& path) {
  STEPControl_Reader reader;
  EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
  reader.TransferRoots();
  const TopoDS_Shape shape = reader.OneShape();
  Topology t{BRepCheck_Analyzer(shape).IsValid()};
  for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next()) {
    ++t.faces;
    const TopoDS_Face& face = TopoDS::Face(faces.Current());
    for (TopExp_Explorer wires(face, TopAbs_WIRE); wires.More(); wires.Next()) ++t.wires;
    for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
      ++t.edges;
      t.seams += BRep_Tool::IsClosed(TopoDS::Edge(edges.Current()), face);
      t.degenerated += BRep_Tool::Degenerated(TopoDS::Edge(edges.Current()));
    }
  }
  return t;
}

void ExpectClosedInStep(Form form, const NurbsSurface& surface) {
  const TemporaryFolder folder;
  WriteStep({surface}, folder.File("a.step"));
  const bool torus = form == Form::kTorus;
  EXPECT_EQ(ClosedFlags(folder.Text("a.step")), torus ? ".T.,.T.," : ".T.,.F.,");
  const Topology t = TopologyOf(folder.File("a.step"));
  EXPECT_TRUE(t.valid);
  EXPECT_EQ(t.faces, 1);
  EXPECT_EQ(t.wires, 1);
  EXPECT_EQ(t.edges, 4);
  EXPECT_EQ(t.seams, torus ? 4 : 2);  // seen from both sides
  EXPECT_EQ(t.degenerated, form == Form::kBall ? 2 : 0);

  const std::vector<Geometry> read = ReadStep(folder.File("a.step"));
  ASSERT_EQ(read.size(), 1u);
  const NurbsSurface& back = std::get<NurbsSurface>(read[0]);
  const double largest = surface.control_points().cwiseAbs().maxCoeff();
  EXPECT_LE(WorstGap(surface, back), kStepPrecision * largest);
  EXPECT_EQ(back.basis_u().lower(), surface.basis_u().lower());
  EXPECT_EQ(back.basis_u().upper(), surface.basis_u().upper());
  for (int j = 0; j < back.size_v(); ++j) {
    EXPECT_TRUE(back.control_point(0, j) == back.control_point(back.size_u() - 1, j));
  }
  EXPECT_GE(SeamContinuity(back, Direction::kU).value_or(-1), surface.basis_u().degree() - 1);
  const CollapsedEdgeSet edges = CollapsedEdges(back);
  EXPECT_EQ(edges.v_lower && edges.v_upper, form == Form::kBall);
}

class StepClosedTest : public ::testing::TestWithParam<Form> {};

TEST_P(StepClosedTest, PeriodicSurfacesAreClosedValidAndComeBack) {
  for (const int degree : {2, 3, 5}) {
    for (const double far : {0.0, 1e4}) {
      RandomSplines random(kSeed + degree);
      for (int k = 0; k < 4; ++k) {
        SCOPED_TRACE(testing::Message() << "seed " << kSeed + degree << ", degree " << degree
                                        << ", case " << k << ", far " << far);
        ExpectClosedInStep(GetParam(), Lumpy(GetParam(), degree, random, far));
      }
    }
  }
}

TEST_P(StepClosedTest, JsonKeepsThemPeriodicBitByBit) {
  RandomSplines random(kSeed);
  for (const int degree : {2, 3, 5}) {
    const TemporaryFolder folder;
    const NurbsSurface surface = Lumpy(GetParam(), degree, random, 10);
    WriteGeometry({surface}, folder.File("a.json"));
    EXPECT_EQ(std::get<NurbsSurface>(ReadGeometry(folder.File("a.json")).at(0)), surface);
    const std::string flags =
        GetParam() == Form::kTorus ? "\"periodic\": [true, true]" : "\"periodic\": [true, false]";
    EXPECT_NE(folder.Text("a.json").find(flags), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(Forms,
                         StepClosedTest,
                         ::testing::Values(Form::kTube, Form::kTorus, Form::kBall));

}  // namespace batten::internal::step_closed_test
