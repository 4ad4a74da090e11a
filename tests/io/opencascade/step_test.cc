// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepCheck_Analyzer.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Reader.hxx>
#include <STEPControl_Writer.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <gp_Trsf.hxx>
#include <gp_Vec.hxx>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "batten/io/read_error.h"
#include "batten/io/step_reader.h"
#include "batten/io/step_writer.h"
#include "random_geometry.h"
#include "temporary_folder.h"

namespace batten::internal::step_test {

using ::testing::HasSubstr;
using ::testing::internal::CaptureStderr;
using ::testing::internal::CaptureStdout;
using ::testing::internal::GetCapturedStderr;
using ::testing::internal::GetCapturedStdout;

constexpr unsigned kSeed = 20240531;

// Reals are written with all their digits, so reading back may round a few times at most; the
// contract is this, relative to the largest number.
constexpr double kStepPrecision = 1e-12;

// The shape in a file, read by OpenCASCADE alone in the unit given in millimetres.
TopoDS_Shape Oracle(const std::string& path, double unit, std::string* unit_name = nullptr) {
  STEPControl_Controller::Init();
  STEPControl_Reader reader;
  EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.FileUnits(lengths, angles, solid_angles);
  if (unit_name) *unit_name = lengths.First().ToCString();
  reader.SetSystemLengthUnit(unit);
  reader.TransferRoots();
  return reader.OneShape();
}

template <typename Knot, typename Multiplicity>
void ExpectKnots(const SplineBasis& basis, int count, Knot knot, Multiplicity multiplicity) {
  std::vector<double> knots;
  for (int i = 1; i <= count; ++i) knots.insert(knots.end(), multiplicity(i), knot(i));
  ASSERT_EQ(knots.size(), basis.knots().size());
  for (size_t i = 0; i < knots.size(); ++i) {
    EXPECT_NEAR(knots[i], basis.knots()[i], kStepPrecision * std::abs(basis.knots()[i]));
  }
}

void ExpectSame(const Geom_BSplineSurface& read, const NurbsSurface& surface) {
  ASSERT_EQ(read.UDegree(), surface.basis_u().degree());
  ASSERT_EQ(read.VDegree(), surface.basis_v().degree());
  ExpectKnots(
      surface.basis_u(),
      read.NbUKnots(),
      [&](int i) { return read.UKnot(i); },
      [&](int i) { return read.UMultiplicity(i); });
  ExpectKnots(
      surface.basis_v(),
      read.NbVKnots(),
      [&](int i) { return read.VKnot(i); },
      [&](int i) { return read.VMultiplicity(i); });
  const double scale = surface.control_points().cwiseAbs().maxCoeff();
  for (int i = 0; i < surface.size_u(); ++i) {
    for (int j = 0; j < surface.size_v(); ++j) {
      const gp_Pnt pole = read.Pole(i + 1, j + 1);
      const Eigen::Vector3d point(pole.X(), pole.Y(), pole.Z());
      EXPECT_LE((point - surface.control_point(i, j)).norm(), kStepPrecision * scale);
      const double weight = surface.weights()[i * surface.size_v() + j];
      EXPECT_NEAR(read.Weight(i + 1, j + 1), weight, kStepPrecision * weight);
    }
  }
}

void ExpectSame(const NurbsSurface& read, const NurbsSurface& surface) {
  ASSERT_EQ(read.basis_u().degree(), surface.basis_u().degree());
  ASSERT_EQ(read.basis_v().degree(), surface.basis_v().degree());
  ASSERT_EQ(read.basis_u().knots(), surface.basis_u().knots());
  ASSERT_EQ(read.basis_v().knots(), surface.basis_v().knots());
  EXPECT_TRUE(read.control_points().isApprox(surface.control_points(), kStepPrecision));
  EXPECT_TRUE(read.weights().isApprox(surface.weights(), kStepPrecision));
}

// Writes the surface, reads it by OpenCASCADE and by batten. Where OpenCASCADE makes closed
// surfaces periodic, which the file does not say, only its validity is asked of it.
void ExpectExactInStep(const NurbsSurface& surface, double largest_tolerance = 1e-7) {
  const TemporaryFolder folder;
  WriteStep({surface}, folder.File("a.step"));

  const TopoDS_Shape shape = Oracle(folder.File("a.step"), 1);
  EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
  TopExp_Explorer faces(shape, TopAbs_FACE);
  ASSERT_TRUE(faces.More());
  const TopoDS_Face& face = TopoDS::Face(faces.Current());
  const auto read = Handle(Geom_BSplineSurface)::DownCast(BRep_Tool::Surface(face));
  ASSERT_FALSE(read.IsNull());
  if (!read->IsUPeriodic() && !read->IsVPeriodic()) {
    ASSERT_NO_FATAL_FAILURE(ExpectSame(*read, surface));
  }
  for (TopExp_Explorer edges(shape, TopAbs_EDGE); edges.More(); edges.Next()) {
    EXPECT_LE(BRep_Tool::Tolerance(TopoDS::Edge(edges.Current())), largest_tolerance);
  }
  faces.Next();
  EXPECT_FALSE(faces.More());

  const std::vector<Geometry> back = ReadStep(folder.File("a.step"));
  ASSERT_EQ(back.size(), 1u);
  ExpectSame(std::get<NurbsSurface>(back[0]), surface);
}

// An eighth of the unit sphere in u and the whole turn in v would hide a seam; this is all of it: a
// half circle turned once, with two points for edges and one seam.
NurbsSurface Sphere() {
  const double h = std::numbers::sqrt2 / 2;
  Eigen::Matrix<double, 2, 5> profile;
  profile << 0, 1, 1, 1, 0, -1, -1, 0, 1, 1;
  const Eigen::Matrix<double, 5, 1> profile_weights(1, h, 1, h, 1);
  Eigen::Matrix<double, 2, 9> circle;
  circle << 1, 1, 0, -1, -1, -1, 0, 1, 1, 0, 1, 1, 1, 0, -1, -1, -1, 0;
  Eigen::Matrix3Xd points(3, 45);
  Eigen::VectorXd weights(45);
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 5; ++j) {
      points.col(i * 5 + j) << circle.col(i) * profile(0, j), profile(1, j);
      weights[i * 5 + j] = (i % 2 ? h : 1) * profile_weights[j];
    }
  }
  return NurbsSurface(SplineBasis(2, {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4}),
                      SplineBasis(2, {0, 0, 0, 1, 1, 2, 2, 2}),
                      std::move(points),
                      std::move(weights));
}

TEST(StepTest, KeepsSurfacesExactAndValid) {
  SCOPED_TRACE(kSeed);
  RandomGeometry random(kSeed);
  for (int degree_u = 1; degree_u <= 7; ++degree_u) {
    for (const bool rational : {true, false}) {
      const int degree_v = random.Integer(1, 7);
      SCOPED_TRACE(testing::Message() << degree_u << " x " << degree_v << " rational " << rational);
      ExpectExactInStep(random.Surface(degree_u, degree_v, true, rational));
    }
  }
}

// As KittyCAD's files have it: `$` stands for a value that is not given.
TEST(StepTest, ADescriptionMayBeLeftOut) {
  RandomGeometry random(kSeed);
  const TemporaryFolder folder;
  const NurbsSurface surface = random.Surface(3, 2, true, false);
  WriteStep({surface}, folder.File("a.step"));
  std::string text = folder.Text("a.step");
  const std::string words = "'confusion accuracy'";
  const auto at = text.find(words);
  ASSERT_NE(at, text.npos);
  text.replace(at, words.size(), "$");
  const std::vector<Geometry> back = ReadStep(folder.With("b.step", text));
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(std::get<NurbsSurface>(back[0]).control_points(),
            std::get<NurbsSurface>(ReadStep(folder.File("a.step"))[0]).control_points());
}

TEST(StepTest, KeepsUnclampedSurfacesExactAndValid) {
  SCOPED_TRACE(kSeed);
  RandomGeometry random(kSeed);
  for (int degree = 1; degree <= 7; ++degree) {
    SCOPED_TRACE(degree);
    ExpectExactInStep(random.Surface(degree, random.Integer(1, 7), false, degree % 2 == 0));
  }
}

TEST(StepTest, KeepsTheHighestDegreeExactAndValid) {
  RandomGeometry random(kSeed);
  ExpectExactInStep(random.Surface(kMaxDegree, 3, true, false), 1e-5);
}

TEST(StepTest, KeepsCurvesExact) {
  SCOPED_TRACE(kSeed);
  RandomGeometry random(kSeed);
  for (int degree = 1; degree <= 7; ++degree) {
    for (const bool clamped : {true, false}) {
      for (const bool rational : {true, false}) {
        SCOPED_TRACE(testing::Message() << degree << " clamped " << clamped << ' ' << rational);
        const TemporaryFolder folder;
        const auto curve = random.Curve<3>(degree, clamped, rational);
        WriteStep({curve}, folder.File("a.step"));
        const std::vector<Geometry> back = ReadStep(folder.File("a.step"));
        ASSERT_EQ(back.size(), 1u);
        const auto& read = std::get<NurbsCurve<3>>(back[0]);
        EXPECT_EQ(read.basis(), curve.basis());
        EXPECT_TRUE(read.control_points().isApprox(curve.control_points(), kStepPrecision));
        EXPECT_TRUE(read.weights().isApprox(curve.weights(), kStepPrecision));
      }
    }
  }
}

TEST(StepTest, PutsPlaneCurvesAtHeightZero) {
  RandomGeometry random(kSeed);
  const TemporaryFolder folder;
  const auto curve = random.Curve<2>(3, true, true);
  WriteStep({curve}, folder.File("a.step"));
  const auto read = std::get<NurbsCurve<3>>(ReadStep(folder.File("a.step")).at(0));
  EXPECT_TRUE(read.control_points().topRows<2>().isApprox(curve.control_points(), kStepPrecision));
  EXPECT_TRUE(read.control_points().row(2).isZero(0));
}

TEST(StepTest, KeepsDegenerateAndSeamEdges) { ExpectExactInStep(Sphere()); }

TEST(StepTest, KeepsSurfacesWithCoincidingControlPoints) {
  Eigen::Matrix3Xd points(3, 16);
  for (int i = 0; i < 16; ++i) points.col(i) << i / 4, std::min(i % 4, 2), (i / 4) % 2;
  ExpectExactInStep(
      NurbsSurface(SplineBasis::Uniform(3, 4, 0, 1), SplineBasis::Uniform(2, 4, 0, 1), points));
}

TEST(StepTest, KeepsSurfacesFarFromTheOrigin) {
  RandomGeometry random(kSeed);
  ExpectExactInStep(random.Surface(3, 3, true, false).Translated({500000, 5400000, 300}));
}

TEST(StepTest, KeepsSeveralGeometriesInOrder) {
  RandomGeometry random(kSeed);
  const TemporaryFolder folder;
  const std::vector<Geometry> mixed = {random.Curve<3>(3, true, false),
                                       random.Surface(2, 3, true, true),
                                       random.Curve<3>(2, true, true),
                                       random.Surface(3, 1, true, false)};
  WriteStep(mixed, folder.File("a.step"));
  const std::vector<Geometry> back = ReadStep(folder.File("a.step"));
  ASSERT_EQ(back.size(), mixed.size());
  for (size_t i = 0; i < mixed.size(); ++i) EXPECT_EQ(back[i].index(), mixed[i].index());
  ExpectSame(std::get<NurbsSurface>(back[1]), std::get<NurbsSurface>(mixed[1]));
  ExpectSame(std::get<NurbsSurface>(back[3]), std::get<NurbsSurface>(mixed[3]));
}

TEST(StepTest, DeclaresTheUnitAndNeverScales) {
  RandomGeometry random(kSeed);
  const auto surface = random.Surface(3, 2, true, true);
  const struct {
    const char *unit, *name;
    double millimetres;
  } units[] = {{"mm", "millimetre", 1},
               {"m", "metre", 1000},
               {"inch", "INCH", 25.4},
               {"cm", "centimetre", 10},
               {"ft", "FOOT", 304.8},
               {"um", "micrometre", 1e-3}};
  for (const auto& [unit, name, millimetres] : units) {
    SCOPED_TRACE(unit);
    const TemporaryFolder folder;
    WriteStep({surface}, folder.File("a.step"), unit);
    std::string declared;
    const TopoDS_Shape shape = Oracle(folder.File("a.step"), millimetres, &declared);
    EXPECT_EQ(declared, name);
    const TopExp_Explorer faces(shape, TopAbs_FACE);
    ASSERT_TRUE(faces.More());
    const auto face = TopoDS::Face(faces.Current());
    ExpectSame(*Handle(Geom_BSplineSurface)::DownCast(BRep_Tool::Surface(face)), surface);
    ExpectSame(std::get<NurbsSurface>(ReadStep(folder.File("a.step")).at(0)), surface);
  }
}

TEST(StepTest, NamesTheUnitsItKnowsWhenAskedForAnother) {
  const TemporaryFolder folder;
  RandomGeometry random(kSeed);
  try {
    WriteStep({random.Surface(1, 1, true, false)}, folder.File("a.step"), "furlong");
    FAIL() << "nothing was thrown";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("unit \"furlong\" is not one of mm, cm, m"));
  }
  EXPECT_EQ(folder.Entries(), 0);
}

TEST(StepTest, WritesTheSameBytesForTheSameGeometry) {
  const TemporaryFolder folder;
  RandomGeometry random(kSeed);
  const std::vector<Geometry> geometry = {random.Surface(3, 2, true, true),
                                          random.Curve<3>(3, true, false)};
  ::unsetenv("SOURCE_DATE_EPOCH");
  WriteStep(geometry, folder.File("a.step"));
  WriteStep(geometry, folder.File("b.step"), "m");
  WriteStep(geometry, folder.File("c.step"));
  EXPECT_EQ(folder.Text("a.step"), folder.Text("c.step"));
  EXPECT_NE(folder.Text("a.step"), folder.Text("b.step"));
  EXPECT_THAT(folder.Text("a.step"), HasSubstr("'1970-01-01T00:00:00'"));

  ::setenv("SOURCE_DATE_EPOCH", "1717156800", 1);
  WriteStep(geometry, folder.File("d.step"));
  EXPECT_THAT(folder.Text("d.step"), HasSubstr("'2024-05-31T12:00:00'"));
  ::setenv("SOURCE_DATE_EPOCH", "nonsense", 1);
  WriteStep(geometry, folder.File("d.step"));
  ::unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_EQ(folder.Text("d.step"), folder.Text("a.step"));
}

TEST(StepTest, RefusesWhatHasNoValidBoundary) {
  const TemporaryFolder folder;
  // All control points in one place: every edge is a point.
  const NurbsSurface point(SplineBasis::Uniform(1, 2, 0, 1),
                           SplineBasis::Uniform(1, 2, 0, 1),
                           Eigen::Matrix3Xd::Zero(3, 4));
  EXPECT_THROW(WriteStep({point}, folder.File("a.step")), WriteError);
  EXPECT_THROW(WriteStep({}, folder.File("a.step")), std::invalid_argument);
  EXPECT_EQ(folder.Entries(), 0);
}

TEST(StepTest, PrintsNothing) {
  const TemporaryFolder folder;
  RandomGeometry random(kSeed);
  CaptureStdout();
  CaptureStderr();
  WriteStep({random.Surface(3, 2, true, true)}, folder.File("a.step"));
  ReadStep(folder.File("a.step"));
  std::string damaged = folder.Text("a.step");
  damaged.replace(damaged.find("B_SPLINE_SURFACE"), 4, "#,((");
  EXPECT_THROW(ReadStep(folder.With("b.step", damaged)), ReadError);
  EXPECT_EQ(GetCapturedStdout(), "");
  EXPECT_EQ(GetCapturedStderr(), "");
}

std::string Refusal(const TemporaryFolder& folder, const std::string& text) {
  try {
    ReadStep(folder.With("bad.step", text));
  } catch (const ReadError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "must be one line";
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

TEST(StepTest, RefusesWhatIsNotWholeStep) {
  const TemporaryFolder folder;
  RandomGeometry random(kSeed);
  WriteStep({random.Surface(3, 2, true, true)}, folder.File("a.step"));
  const std::string good = folder.Text("a.step");

  EXPECT_THAT(Refusal(folder, "solid x\nfacet normal"), HasSubstr("is not a STEP file"));
  EXPECT_THAT(Refusal(folder, std::string(1000, '\0')), HasSubstr("is not a STEP file"));
  EXPECT_THAT(Refusal(folder, good.substr(0, good.size() / 2)), HasSubstr("is truncated"));
  EXPECT_THAT(Refusal(folder, "ISO-10303-21;\nEND-ISO-10303-21;\n"), HasSubstr("bad.step: "));
  const size_t data = good.find("DATA;");
  EXPECT_THAT(Refusal(folder, good.substr(0, data) + "DATA;\nENDSEC;\nEND-ISO-10303-21;\n"),
              HasSubstr("bad.step: "));
  std::string zero = good;
  zero[data + 6] = '\0';
  EXPECT_THAT(Refusal(folder, zero), HasSubstr("line 9: is damaged: an instance"));
  const auto with = [&](const std::string& old, const std::string& text) {
    std::string result = good;
    return Refusal(folder, result.replace(result.find(old), old.size(), text));
  };
  EXPECT_THAT(with("#9 =", "#8 ="), HasSubstr("is damaged: #8 is defined twice"));
  EXPECT_THAT(with(",#9)", ",#99999)"), HasSubstr("is damaged: #99999 is not defined"));
  EXPECT_THAT(with("#8 = PRODUCT_CONTEXT('',#2,", "#8 = PRODUCT_CONTEXT('',#7,"),
              HasSubstr("refers to itself"));
  EXPECT_THAT(with("CARTESIAN_POINT('',(", "CARTESIAN_POINT('',(1.E999,"),
              HasSubstr("'1.E999' is not a number that fits a double"));
  EXPECT_THAT(with("CARTESIAN_POINT('',(", "CARTESIAN_POINT('',(" + std::string(200'000, '(')),
              HasSubstr("nested deeper than 64 levels"));
  EXPECT_THROW(ReadStep(folder.File("missing.step")), ReadError);
  EXPECT_THROW(ReadStep(folder.path().string()), ReadError);
}

// As editors and version control of another system leave it.
TEST(StepTest, ReadsLinesThatEndInCarriageReturns) {
  const TemporaryFolder folder;
  const NurbsSurface surface = Sphere();
  WriteStep({surface}, folder.File("a.step"));
  std::string changed;
  for (const char c : folder.Text("a.step")) changed += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(ReadStep(folder.With("b.step", changed)), ReadStep(folder.File("a.step")));
}

TEST(StepTest, RefusesAVertexWithoutAPointInSpace) {
  const TemporaryFolder folder;
  WriteStep({Sphere()}, folder.File("a.step"));
  std::string text = folder.Text("a.step");
  const std::string vertex = "VERTEX_POINT('',";
  const size_t at = text.find(vertex);
  ASSERT_NE(at, text.npos);
  const size_t name = at + vertex.size();  // of its point
  const std::string open =
      "\n" + text.substr(name, text.find(')', name) - name) + " = CARTESIAN_POINT('',(";
  ASSERT_NE(text.find(open), text.npos);
  const size_t point = text.find(open) + open.size();
  text.replace(point, text.find(')', point) - point, "1.");
  try {
    ReadStep(folder.With("b.step", text));
    ADD_FAILURE() << "it was read";
  } catch (const ReadError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a vertex needs a point of three coordinates"));
  }
}

TEST(StepTest, SurvivesDamage) {
  SCOPED_TRACE(kSeed);
  const TemporaryFolder folder;
  RandomGeometry random(kSeed);
  WriteStep({random.Surface(3, 2, true, true), random.Curve<3>(2, true, false)},
            folder.File("a.step"));
  const std::string good = folder.Text("a.step");
  const std::string characters = "0123456789.,()#'$*;EABT-/ \n";
  int refused = 0;
  for (int k = 0; k < 150; ++k) {
    std::string damaged = good;
    for (int i = random.Integer(1, 6); i > 0; --i) {
      damaged[random.Integer(40, static_cast<int>(good.size()) - 20)] =
          characters[random.Integer(0, static_cast<int>(characters.size()) - 1)];
    }
    try {
      ReadStep(folder.With("bad.step", damaged));
    } catch (const ReadError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
}

// What OpenCASCADE writes of its own primitives.
std::string WithPrimitive(const TemporaryFolder& folder, const TopoDS_Shape& shape) {
  STEPControl_Controller::Init();
  Interface_Static::SetCVal("write.step.unit", "MM");
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  STEPControl_Writer writer;
  writer.Transfer(shape, STEPControl_AsIs);
  writer.Write(folder.File("primitive.step").c_str());
  return folder.File("primitive.step");
}

TEST(StepTest, TurnsAPeriodicTorusIntoClampedNurbs) {
  const TemporaryFolder folder;
  const std::string path = WithPrimitive(folder, BRepPrimAPI_MakeTorus(3, 1).Shape());
  const std::vector<Geometry> back = ReadStep(path);
  ASSERT_EQ(back.size(), 1u);
  const auto& torus = std::get<NurbsSurface>(back[0]);
  for (const SplineBasis* basis : {&torus.basis_u(), &torus.basis_v()}) {
    EXPECT_EQ(basis->Multiplicity(basis->lower()), basis->degree() + 1);
    EXPECT_EQ(basis->Multiplicity(basis->upper()), basis->degree() + 1);
  }
  for (int i = 0; i <= 10; ++i) {
    for (int j = 0; j <= 10; ++j) {
      const double u =
          torus.basis_u().lower() + i / 10.0 * (torus.basis_u().upper() - torus.basis_u().lower());
      const double v =
          torus.basis_v().lower() + j / 10.0 * (torus.basis_v().upper() - torus.basis_v().lower());
      const Eigen::Vector3d point = torus.At(u, v);
      EXPECT_NEAR(std::hypot(point.head<2>().norm() - 3, point.z()), 1, kStepPrecision * 10);
    }
  }
}

TEST(StepTest, SaysWhatIsFlattened) {
  const TemporaryFolder folder;
  const auto flattened = [&](const TopoDS_Shape& shape) {
    return ReadStepContents(WithPrimitive(folder, shape)).flattened;
  };
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 2, 3).Shape();
  EXPECT_EQ(flattened(box),
            "a solid is flattened: 6 surfaces and curves where they stand, each by itself");
  TopoDS_Compound pair;
  BRep_Builder().MakeCompound(pair);
  gp_Trsf aside;
  aside.SetTranslation(gp_Vec(5, 0, 0));
  BRep_Builder().Add(pair, box);
  BRep_Builder().Add(pair, box.Moved(aside));
  const int assembly = Interface_Static::IVal("write.step.assembly");
  Interface_Static::SetIVal("write.step.assembly", 0);
  EXPECT_THAT(flattened(pair), HasSubstr("2 solids are flattened: 12 "));
  Interface_Static::SetIVal("write.step.assembly", 1);
  EXPECT_THAT(flattened(pair), HasSubstr("assembly of 2 placed parts with 2 solids is"));
  Interface_Static::SetIVal("write.step.assembly", assembly);
  WriteStep({RandomGeometry(kSeed).Surface(3, 2, false, false)}, folder.File("face.step"), "mm");
  EXPECT_TRUE(ReadStepContents(folder.File("face.step")).flattened.empty());
}

// Knots 0 … 8 and beyond, eight control points to the round: a smooth periodic basis.
SplineBasis RoundBasis(int degree) {
  std::vector<double> knots;
  for (int i = -degree; i <= 8 + degree; ++i) knots.push_back(i);
  return SplineBasis::Periodic(degree, std::move(knots));
}

double Angle(int i) { return i % 8 * std::numbers::pi / 4; }

void ExpectClampedAndClosed(const SplineBasis& basis, const Eigen::Vector3d& gap) {
  EXPECT_TRUE(basis.clamped());
  EXPECT_FALSE(basis.periodic());
  EXPECT_EQ(gap, Eigen::Vector3d::Zero());
}

TEST(StepTest, WritesPeriodicCurvesClosed) {
  for (const bool rational : {false, true}) {
    for (int degree = 1; degree <= 5; ++degree) {
      const SplineBasis basis = RoundBasis(degree);
      Eigen::Matrix3Xd points(3, basis.size());
      Eigen::VectorXd weights(basis.size());
      for (int i = 0; i < basis.size(); ++i) {
        points.col(i) << std::cos(Angle(i)), std::sin(Angle(i)), 0.1 * std::sin(2 * Angle(i));
        weights[i] = rational ? 1 + i % 8 % 3 : 1;
      }
      const NurbsCurve<3> curve(basis, points, weights);
      const TemporaryFolder folder;
      WriteStep({curve}, folder.File("a.step"));
      const auto back = std::get<NurbsCurve<3>>(ReadStep(folder.File("a.step"))[0]);
      ExpectClampedAndClosed(back.basis(),
                             back.control_points().col(0) - back.control_points().rightCols<1>());
      for (double u = 0; u <= 8; u += 0.37) {
        EXPECT_LT((back.At(u) - curve.At(u)).norm(), kStepPrecision) << degree << ' ' << u;
      }
    }
  }
}

TEST(StepTest, WritesPeriodicSurfacesClosedAndValid) {
  // A tube round in u, one round in v, and a torus.
  for (const auto& [round_u, round_v] : {std::pair{true, false}, {false, true}, {true, true}}) {
    const SplineBasis bu = round_u ? RoundBasis(3) : SplineBasis::Uniform(2, 5, 0, 8);
    const SplineBasis bv = round_v ? RoundBasis(2) : SplineBasis::Uniform(3, 6, 0, 8);
    Eigen::Matrix3Xd points(3, bu.size() * bv.size());
    for (int i = 0; i < bu.size(); ++i) {
      for (int j = 0; j < bv.size(); ++j) {
        const double along = round_u ? Angle(i) : Angle(j), across = round_u ? j : i;
        const double r = round_u && round_v ? 3 + std::cos(Angle(j)) : 2 + 0.1 * across;
        const double z = round_u && round_v ? std::sin(Angle(j)) : across;
        points.col(i * bv.size() + j) << r * std::cos(along), r * std::sin(along), z;
      }
    }
    const NurbsSurface surface(bu, bv, points);
    const TemporaryFolder folder;
    WriteStep({surface}, folder.File("a.step"));
    EXPECT_TRUE(BRepCheck_Analyzer(Oracle(folder.File("a.step"), 1)).IsValid());
    const auto back = std::get<NurbsSurface>(ReadStep(folder.File("a.step"))[0]);
    for (int j = 0; round_u && j < back.size_v(); ++j) {
      ExpectClampedAndClosed(back.basis_u(),
                             back.control_point(0, j) - back.control_point(back.size_u() - 1, j));
    }
    for (int i = 0; round_v && i < back.size_u(); ++i) {
      ExpectClampedAndClosed(back.basis_v(),
                             back.control_point(i, 0) - back.control_point(i, back.size_v() - 1));
    }
    for (double u = 0; u <= 8; u += 0.73) {
      for (double v = 0; v <= 8; v += 0.61) {
        EXPECT_LT((back.At(u, v) - surface.At(u, v)).norm(), 5 * kStepPrecision);
      }
    }
  }
}

// Readers take points within 1e-7 for one: such a file came back empty or as another shape.
TEST(StepTest, ShapesBelowThePrecisionOfReadersAreRefused) {
  TemporaryFolder folder;
  for (const double size : {1e-300, 1e-160, 1e-9}) {
    Eigen::Matrix3Xd net(3, 4);
    net << 0, 0, size, size, 0, size, 0, size, 0, 0, 0, size;
    const SplineBasis line = SplineBasis::Uniform(1, 2, 0, 1);
    try {
      WriteStep({NurbsSurface(line, line, net)}, folder.File("a.step"));
      ADD_FAILURE() << "written";
    } catch (const WriteError& error) {
      EXPECT_THAT(error.what(), HasSubstr("smaller unit"));
    }
  }
}

}  // namespace batten::internal::step_test
