// SPDX-License-Identifier: MIT
// Curves, surfaces and trimmed surfaces through IGES.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include "angles.h"
#include "batten/geometry/clamp.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/surface_area.h"
#include "batten/geometry/trim_loops.h"
#include "batten/io/geometry_file.h"
#include "batten/io/iges_reader.h"
#include "batten/io/iges_writer.h"
#include "batten/io/read_error.h"
#include "random_geometry.h"
#include "random_trims.h"
#include "temporary_folder.h"

namespace batten::internal::iges_test {

using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr unsigned kSeed = 816;
void ExpectExact(const std::vector<Geometry>& geometry) {
  const TemporaryFolder folder;
  WriteIges(geometry, folder.File("a.igs"));
  const std::vector<Geometry> back = ReadIges(folder.File("a.igs"));
  ASSERT_EQ(back.size(), geometry.size());
  for (size_t i = 0; i < geometry.size(); ++i) EXPECT_TRUE(back[i] == geometry[i]) << i;
}

std::string Bytes(const std::string& path) {
  std::ifstream file(path);
  return std::string((std::istreambuf_iterator<char>(file)), {});
}

void Put(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

// What OpenCASCADE makes of a file.
struct Oracle {
  explicit Oracle(const std::string& path) {
    IGESControl_Controller::Init();
    EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
    reader.TransferRoots();
    shape = reader.OneShape();
  }
  int Count(TopAbs_ShapeEnum kind) const {
    int count = 0;
    for (TopExp_Explorer all(shape, kind); all.More(); all.Next()) ++count;
    return count;
  }
  double Area() const {
    GProp_GProps properties;
    BRepGProp::SurfaceProperties(shape, properties, 1e-6);
    return properties.Mass();
  }

  IGESControl_Reader reader;
  TopoDS_Shape shape;
};

TEST(IgesTest, KeepsCurvesAndSurfacesBitByBit) {
  SCOPED_TRACE(kSeed);
  RandomGeometry random(kSeed);
  for (int degree = 1; degree <= 7; ++degree) {
    for (const bool clamped : {true, false}) {
      SCOPED_TRACE(testing::Message() << degree << " clamped " << clamped);
      ExpectExact({random.Curve<3>(degree, clamped, degree % 2),
                   random.Surface(degree, random.Integer(1, 7), clamped, degree % 3 == 0),
                   random.Curve<3>(degree, clamped, false)});
    }
  }
  ExpectExact({random.Curve<3>(kMaxDegree, true, true), random.Surface(kMaxDegree, 2, true, true)});
}

TEST(IgesTest, KeepsTrimLoopsBitByBit) {
  SCOPED_TRACE(kSeed);
  RandomGeometry random(kSeed);
  RandomTrims trims(kSeed);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    ExpectExact({trims.Trimmed(
        random.Surface(random.Integer(1, 5), random.Integer(1, 5), i % 2, i % 3 == 0), i % 5)});
  }
}

TEST(IgesTest, PutsPlaneCurvesAtZeroAndClampsPeriodicOnes) {
  RandomGeometry random(kSeed);
  const TemporaryFolder folder;
  const auto plane = random.Curve<2>(3, true, true);
  const Frame frame({1, 2, 3}, {0, 0, 1}, {1, 0, 0});
  const NurbsSurface tube =
      Periodic(MakeCylinder(frame, 2, {0, 5}, {0, 2 * kPi}), Direction::kU, 1e-9);
  const NurbsSurface trimmed = RandomTrims(kSeed).Trimmed(tube, 2);
  WriteIges({plane, trimmed}, folder.File("a.iges"));
  const std::vector<Geometry> back = ReadIges(folder.File("a.iges"));
  ASSERT_EQ(back.size(), 2u);
  const auto& curve = std::get<NurbsCurve<3>>(back[0]);
  EXPECT_EQ(curve.basis(), plane.basis());
  EXPECT_EQ(curve.control_points().topRows<2>(), plane.control_points());
  EXPECT_TRUE(curve.control_points().row(2).isZero(0));
  EXPECT_TRUE(std::get<NurbsSurface>(back[1]) ==
              Clamped(tube, Direction::kU).WithTrims(trimmed.trims()));
}

NurbsSurface WithWhole(const NurbsSurface& surface, bool hole) {
  std::vector<NurbsCurve<2>> loops = {
      RandomTrims::Polygon(surface, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, true)};
  if (hole) loops.push_back(RandomTrims(1).Circle(surface, {0.3, 0.7, 0.3, 0.7}, false));
  return surface.WithTrims(loops);
}

TEST(IgesTest, KeepsLoopsAlongSeamsAndPoles) {
  const Frame frame({1, 2, 3}, {0, 0.6, 0.8}, {1, 0, 0});
  ExpectExact({WithWhole(MakeCylinder(frame, 2, {0, 5}, {0, 2 * kPi}), true)});
  ExpectExact({WithWhole(MakeSphere(frame, 2, {0, 2 * kPi}, {-kPi / 2, kPi / 2}), true)});
  ExpectExact({WithWhole(MakeTorus(frame, 4, 1, {0, 2 * kPi}, {0, 2 * kPi}), true)});
}

TEST(IgesTest, WholeDomainsComeBackUntrimmed) {
  RandomGeometry random(kSeed);
  const TemporaryFolder folder;
  const NurbsSurface surface = random.Surface(3, 2, true, false);
  WriteIges({WithWhole(surface, false)}, folder.File("a.igs"));
  EXPECT_TRUE(std::get<NurbsSurface>(ReadIges(folder.File("a.igs")).at(0)) == surface);
}

// A trimmed surface for every region, each on the whole surface.
TEST(IgesTest, RegionsBecomeTrimmedSurfaces) {
  RandomGeometry random(kSeed);
  RandomTrims trims(kSeed);
  for (int i = 0; i < 10; ++i) {
    SCOPED_TRACE(i);
    const NurbsSurface surface = trims.OfThreeRegions(random.Surface(3, 2, true, i % 2));
    const TemporaryFolder folder;
    WriteIges({surface}, folder.File("a.igs"));
    const std::vector<Geometry> back = ReadIges(folder.File("a.igs"));
    const auto regions = LoopsByRegion(surface);
    ASSERT_EQ(back.size(), regions.size());
    for (size_t k = 0; k < back.size(); ++k)
      EXPECT_TRUE(std::get<NurbsSurface>(back[k]) == surface.WithTrims(regions[k]));
    const Oracle oracle(folder.File("a.igs"));
    EXPECT_TRUE(BRepCheck_Analyzer(oracle.shape).IsValid());
    EXPECT_EQ(oracle.Count(TopAbs_FACE), 3);
    EXPECT_NEAR(oracle.Area(), Area(surface), 1e-3 * Area(surface));
  }
}

// OpenCASCADE finds the same faces, valid, with the wires and the area that the loops bound.
TEST(IgesTest, AnotherReaderFindsValidTrimmedFaces) {
  SCOPED_TRACE(kSeed);
  RandomGeometry random(kSeed);
  RandomTrims trims(kSeed);
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE(i);
    const NurbsSurface surface = random.Surface(3, 2, true, i % 2);
    const NurbsSurface trimmed = trims.Trimmed(surface, 1 + i % 4);
    const TemporaryFolder folder;
    WriteIges({trimmed}, folder.File("a.igs"));
    const Oracle oracle(folder.File("a.igs"));
    EXPECT_TRUE(BRepCheck_Analyzer(oracle.shape).IsValid());
    EXPECT_EQ(oracle.Count(TopAbs_FACE), 1);
    EXPECT_EQ(oracle.Count(TopAbs_WIRE), 1 + i % 4);
    WriteIges({surface}, folder.File("b.igs"));
    const Oracle whole(folder.File("b.igs"));
    EXPECT_EQ(whole.Count(TopAbs_FACE), 1);
    EXPECT_LT(oracle.Area(), whole.Area());
    EXPECT_GT(oracle.Area(), 0);
  }
}

TEST(IgesTest, DeclaresTheUnitAndNeverScales) {
  RandomGeometry random(kSeed);
  const NurbsSurface surface = random.Surface(2, 2, true, false);
  const struct {
    const char* unit;
    int flag;
  } units[] = {{"mm", 2},
               {"cm", 10},
               {"m", 6},
               {"km", 7},
               {"um", 9},
               {"in", 1},
               {"inch", 1},
               {"ft", 4},
               {"mi", 5},
               {"mil", 8},
               {"uin", 11}};
  for (const auto& [unit, flag] : units) {
    const TemporaryFolder folder;
    WriteIges({surface}, folder.File("a.igs"), unit);
    IGESControl_Controller::Init();
    IGESControl_Reader reader;
    ASSERT_EQ(reader.ReadFile(folder.File("a.igs").c_str()), IFSelect_RetDone);
    EXPECT_EQ(reader.IGESModel()->GlobalSection().UnitFlag(), flag) << unit;
    EXPECT_TRUE(ReadIges(folder.File("a.igs")).at(0) == Geometry(surface)) << unit;
  }
  EXPECT_THROW(WriteIges({surface}, "/nowhere/a.igs", "furlong"), UsageError);
}

TEST(IgesTest, GivesTheSameBytesWithTheTimeItIsTold) {
  RandomGeometry random(kSeed);
  const TemporaryFolder folder;
  const NurbsSurface surface = RandomTrims(kSeed).Trimmed(random.Surface(2, 2, true, false), 2);
  WriteIges({surface}, folder.File("a.igs"));
  WriteIges({surface}, folder.File("b.igs"));
  EXPECT_EQ(Bytes(folder.File("a.igs")), Bytes(folder.File("b.igs")));
  EXPECT_THAT(Bytes(folder.File("a.igs")), HasSubstr("15H19700101.000000"));
  ::setenv("SOURCE_DATE_EPOCH", "1717156800", 1);
  WriteIges({surface}, folder.File("b.igs"));
  ::unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_THAT(Bytes(folder.File("b.igs")), HasSubstr("15H20240531.120000"));
}

TEST(IgesTest, FailsWithoutAFile) {
  RandomGeometry random(kSeed);
  EXPECT_THROW(WriteIges({}, "a.igs"), std::invalid_argument);
  EXPECT_THROW(WriteIges({random.Curve<3>(2, true, false)}, "/nowhere/a.igs"), WriteError);
  EXPECT_THROW(ReadIges("/nowhere/a.igs"), ReadError);
}

std::string Refusal(const TemporaryFolder& folder, const std::string& text) {
  Put(folder.File("x.igs"), text);
  try {
    ReadIges(folder.File("x.igs"));
  } catch (const ReadError& error) {
    return error.what();
  }
  return "(read)";
}

TEST(IgesTest, NamesWhatIsWrongWithDamagedFiles) {
  RandomGeometry random(kSeed);
  const TemporaryFolder folder;
  WriteIges({RandomTrims(kSeed).Trimmed(random.Surface(2, 2, true, false), 2)},
            folder.File("a.igs"));
  const std::string good = Bytes(folder.File("a.igs"));
  const auto line = [](const std::string& data, char section) {
    std::string text = data;
    text.resize(72, ' ');
    return text + section + "      1\n";
  };
  const std::string head = line("", 'S') + line("1H,,1H;;", 'G');
  const auto file = [&](const std::string& parameters, const std::string& type) {
    return head +
           line("     " + type + "       1       0       0       0       0       0       000000000",
                'D') +
           line("     " + type + "       0       0       1       0                               0",
                'D') +
           line(parameters, 'P') + line("S1G1D2P1", 'T');
  };
  EXPECT_THAT(Refusal(folder, "hello\n"), HasSubstr("line 1: not a line of IGES: column 73"));
  EXPECT_THAT(Refusal(folder, good.substr(0, good.size() / 2)),
              AnyOf(HasSubstr("ends too early"), HasSubstr("column 73")));
  EXPECT_THAT(Refusal(folder, head + line("", 'T')), HasSubstr("holds no curves or surfaces"));
  EXPECT_THAT(Refusal(folder, file("126,2000000000,3,0,0,1,0,0.;", "126")),
              HasSubstr("entity D1 (type 126): promises more numbers than it has"));
  EXPECT_THAT(Refusal(folder, file("128,9,9,3,3,0,0,1,0,0,0.,0.;", "128")),
              HasSubstr("promises more numbers"));
  EXPECT_THAT(Refusal(folder, file("126,1,1,0,0,1,0,0.,0.,1.,1.", "126")),
              HasSubstr("line 5: the parameters of the entity do not end"));
  EXPECT_THAT(Refusal(folder, file("110,0.,0.,0.,1.,1.,1.;", "126")),
              HasSubstr("the parameters are those of another entity"));
  EXPECT_THAT(
      Refusal(folder, file("126,1,1,0,0,1,0,0.,0.,1.,1.,1.,-1.,0.,0.,0.,1.,0.,0.,0.,1.;", "126")),
      HasSubstr("entity D1 (type 126): NurbsCurve: a weight is not positive"));
  EXPECT_THAT(Refusal(folder, file("126,1,1,0,0,1,0,0.,0.,1.,1.,1.,-1.,0.,0.,0.,1.;", "126")),
              HasSubstr("entity D1 (type 126): "));
  EXPECT_THAT(Refusal(folder, file("110,0.,0.,0.,1.D200,1.,1.;", "110")),
              HasSubstr("coordinate above 1e150"));
  EXPECT_THAT(Refusal(folder, file("190,1,1,0;", "190")),
              HasSubstr("entity D1 (type 190): is of a type that can't be read"));
  EXPECT_THAT(Refusal(folder, file("144,1,1,0,1;", "144")),
              HasSubstr("trims a surface of type 144"));
  EXPECT_THAT(Refusal(folder, file("144,99,1,0,1;", "144")), HasSubstr("names no surface"));
  EXPECT_THAT(Refusal(folder, file("102,1,1;", "102")), HasSubstr("has a curve of type 102"));
}

// Whatever is cut out or changed: read, or refused with a reason.
TEST(IgesTest, SurvivesDamage) {
  SCOPED_TRACE(kSeed);
  RandomGeometry random(kSeed);
  const TemporaryFolder folder;
  WriteIges({RandomTrims(kSeed).Trimmed(random.Surface(2, 2, true, true), 3)},
            folder.File("a.igs"));
  const std::string good = Bytes(folder.File("a.igs"));
  int read = 0;
  for (int i = 0; i < 300; ++i) {
    std::string bad = good;
    for (int k = random.Integer(1, 4); k > 0; --k) {
      const auto at = static_cast<size_t>(random.Integer(0, static_cast<int>(bad.size()) - 1));
      if (bad[at] != '\n') bad[at] = "0192;,-.EDH "[random.Integer(0, 11)];
    }
    read += Refusal(folder, bad) == "(read)";
  }
  EXPECT_LT(read, 300);
}

TEST(IgesTest, FilesAreKnownByTheirExtensions) {
  RandomGeometry random(kSeed);
  const TemporaryFolder folder;
  const std::vector<Geometry> geometry = {
      RandomTrims(kSeed).Trimmed(random.Surface(3, 3, true, true), 3)};
  for (const char* name : {"a.igs", "a.IGES"}) {
    WriteGeometry(geometry, folder.File(name));
    EXPECT_TRUE(ReadGeometry(folder.File(name)) == geometry);
  }
  WriteGeometry(geometry, folder.File("a.dat"), {.format = "iges", .unit = "m"});
  EXPECT_TRUE(ReadGeometry(folder.File("a.dat"), {.format = "igs"}) == geometry);
}

}  // namespace batten::internal::iges_test
