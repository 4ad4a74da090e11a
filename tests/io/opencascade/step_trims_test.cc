// SPDX-License-Identifier: MIT
// Trimmed surfaces through STEP.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>

#include <algorithm>
#include <cmath>
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
#include "batten/io/read_error.h"
#include "batten/io/step_reader.h"
#include "batten/io/step_writer.h"
#include "loop_distance.h"
#include "random_geometry.h"
#include "random_splines.h"
#include "random_trims.h"
#include "temporary_folder.h"

namespace batten::internal::step_trims_test {

constexpr unsigned kSeed = 815;

// What the contract asks for, of the domain.
constexpr double kStepLoops = 1e-6;

int Count(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  int count = 0;
  for (TopExp_Explorer all(shape, kind); all.More(); all.Next()) ++count;
  return count;
}

// The area that OpenCASCADE finds in the file, whose faces must be valid.
double ValidArea(const std::string& path, size_t loops, int faces = 1) {
  STEPControl_Controller::Init();
  STEPControl_Reader reader;
  EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
  reader.TransferRoots();
  const TopoDS_Shape shape = reader.OneShape();
  EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
  EXPECT_EQ(Count(shape, TopAbs_FACE), faces);
  EXPECT_EQ(Count(shape, TopAbs_WIRE), static_cast<int>(loops));
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties, 1e-6);
  return properties.Mass();
}

// Writes and reads it back; its area in space to three digits.
double ExpectKept(const NurbsSurface& surface) {
  const TemporaryFolder folder;
  WriteStep({surface}, folder.File("a.step"));
  const double area = ValidArea(folder.File("a.step"), surface.trims().size());
  const std::vector<Geometry> back = ReadStep(folder.File("a.step"));
  EXPECT_EQ(back.size(), 1u);
  const auto& read = std::get<NurbsSurface>(back.at(0));
  ExpectSameLoops(read, surface, kStepLoops);
  return area;
}

// Where nothing has to be cut at a seam, the loops come back with their own control points.
void ExpectSameControlPoints(const NurbsSurface& surface) {
  const TemporaryFolder folder;
  WriteStep({surface}, folder.File("a.step"));
  const auto read = std::get<NurbsSurface>(ReadStep(folder.File("a.step")).at(0));
  ASSERT_EQ(read.trims().size(), surface.trims().size());
  for (size_t i = 0; i < surface.trims().size(); ++i) {
    const auto &got = read.trims()[i], &want = surface.trims()[i];
    ASSERT_EQ(got.basis().knots().size(), want.basis().knots().size());
    EXPECT_TRUE(got.control_points().isApprox(want.control_points(), 1e-12));
    EXPECT_TRUE(got.weights().isApprox(want.weights(), 1e-12));
  }
}

TEST(StepTrimsTest, KeepsControlPointsOfLoops) {
  SCOPED_TRACE(kSeed);
  RandomGeometry random(kSeed + 1);
  RandomTrims trims(kSeed + 1);
  for (int i = 0; i < 16; ++i) {
    SCOPED_TRACE(i);
    ExpectSameControlPoints(trims.Trimmed(random.Surface(3, 2, true, i % 2), 1 + i % 4));
  }
}

NurbsSurface Placed(const NurbsSurface& surface, double scale, double far) {
  return NurbsSurface(surface.basis_u(),
                      surface.basis_v(),
                      (surface.control_points() * scale).array() + far,
                      surface.weights())
      .WithTrims(surface.trims());
}

TEST(StepTrimsTest, KeepsLoopsFarAwayAndInOtherUnits) {
  SCOPED_TRACE(kSeed);
  RandomGeometry random(kSeed);
  RandomTrims trims(kSeed);
  for (const double scale : {1e-3, 1.0, 1e3, 1e6}) {
    for (const double far : {0.0, 5e6}) {
      if (far > 1e6 * scale * 1e3) continue;
      SCOPED_TRACE(testing::Message() << "scale " << scale << " far " << far);
      ExpectKept(Placed(trims.Trimmed(random.Surface(3, 3, true, false), 3), scale, far));
    }
  }
}

// A face for every region, each on the whole surface.
TEST(StepTrimsTest, RegionsBecomeFaces) {
  RandomGeometry random(kSeed);
  RandomTrims trims(kSeed);
  for (int i = 0; i < 10; ++i) {
    SCOPED_TRACE(i);
    const NurbsSurface surface = trims.OfThreeRegions(random.Surface(3, 2, true, i % 2));
    const TemporaryFolder folder;
    WriteStep({surface}, folder.File("a.step"));
    EXPECT_NEAR(ValidArea(folder.File("a.step"), 5, 3), Area(surface), 1e-3 * Area(surface));
    const std::vector<Geometry> back = ReadStep(folder.File("a.step"));
    const auto regions = LoopsByRegion(surface);
    ASSERT_EQ(back.size(), regions.size());
    for (size_t k = 0; k < back.size(); ++k)
      ExpectSameLoops(std::get<NurbsSurface>(back[k]), surface.WithTrims(regions[k]), kStepLoops);
  }
}

TEST(StepTrimsTest, KeepsLoopsOfRandomSurfaces) {
  SCOPED_TRACE(kSeed);
  RandomGeometry random(kSeed);
  RandomTrims trims(kSeed);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    ExpectKept(trims.Trimmed(
        random.Surface(random.Integer(1, 5), random.Integer(1, 5), i % 2, i % 3 == 0), 1 + i % 4));
  }
}

const Frame kFrame({1, 2, 3}, {0, 0.6, 0.8}, {1, 0, 0});

NurbsSurface Cylinder() { return MakeCylinder(kFrame, 2, {0, 5}, {0, 2 * kPi}); }

TEST(StepTrimsTest, KeepsADiscOnACylinderThatCrossesNoSeam) {
  const NurbsSurface cylinder = Cylinder();
  RandomTrims trims(kSeed);
  const NurbsSurface disc =
      cylinder.WithTrims({trims.Circle(cylinder, {0.2, 0.7, 0.2, 0.8}, true)});
  EXPECT_GT(ExpectKept(disc), 1);
}

// The outer loop runs along the seam on either side.
NurbsSurface WithWhole(const NurbsSurface& surface, bool hole) {
  RandomTrims trims(kSeed);
  std::vector<NurbsCurve<2>> loops = {
      RandomTrims::Polygon(surface, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, true)};
  if (hole) loops.push_back(trims.Circle(surface, {0.3, 0.7, 0.3, 0.7}, false));
  return surface.WithTrims(loops);
}

TEST(StepTrimsTest, KeepsAHoleInAWholeCylinder) { ExpectKept(WithWhole(Cylinder(), true)); }

TEST(StepTrimsTest, KeepsSlantedEndsOfATube) {
  const NurbsSurface cylinder = Cylinder();
  const std::vector<std::pair<double, double>> corners = {
      {0, 0.1}, {0.3, 0}, {1, 0.1}, {1, 0.9}, {0.5, 1}, {0, 0.9}};
  ExpectKept(cylinder.WithTrims({RandomTrims::Polygon(cylinder, corners, true)}));
  // Longer on one side of the seam than on the other.
  const std::vector<std::pair<double, double>> uneven = {
      {0, 0.1}, {0.3, 0}, {1, 0.2}, {1, 0.7}, {0.5, 1}, {0, 0.9}};
  ExpectKept(cylinder.WithTrims({RandomTrims::Polygon(cylinder, uneven, true)}));
}

TEST(StepTrimsTest, KeepsHolesInSpheresAndTori) {
  const NurbsSurface sphere = MakeSphere(kFrame, 2, {0, 2 * kPi}, {-kPi / 2, kPi / 2});
  EXPECT_NEAR(ExpectKept(WithWhole(sphere, true)), 16 * kPi, 16 * kPi);
  const NurbsSurface torus = MakeTorus(kFrame, 4, 1, {0, 2 * kPi}, {0, 2 * kPi});
  ExpectKept(WithWhole(torus, true));
  // A cap round the pole.
  ExpectKept(sphere.WithTrims(
      {RandomTrims::Polygon(sphere, {{0, 0.6}, {0.5, 0.5}, {1, 0.6}, {1, 1}, {0, 1}}, true)}));
}

TEST(StepTrimsTest, KeepsLoopsOfPeriodicSurfaces) {
  SCOPED_TRACE(kSeed);
  RandomSplines random(kSeed);
  RandomTrims trims(kSeed);
  const NurbsSurface tube = Periodic(Cylinder(), Direction::kU, 1e-9);
  for (int i = 0; i < 8; ++i) {
    SCOPED_TRACE(i);
    ExpectKept(trims.Trimmed(tube, 1 + i % 4));
  }
  ExpectKept(WithWhole(tube, true));
}

TEST(StepTrimsTest, WholeDomainsComeBackUntrimmed) {
  const TemporaryFolder folder;
  RandomGeometry random(kSeed);
  WriteStep({WithWhole(random.Surface(3, 2, true, false), false)}, folder.File("a.step"));
  EXPECT_FALSE(std::get<NurbsSurface>(ReadStep(folder.File("a.step")).at(0)).trimmed());
}

TEST(StepTrimsTest, GivesTheSameBytesAgain) {
  const TemporaryFolder folder;
  RandomGeometry random(kSeed);
  const NurbsSurface surface = RandomTrims(kSeed).Trimmed(random.Surface(3, 2, true, false), 3);
  WriteStep({surface}, folder.File("a.step"));
  WriteStep({surface}, folder.File("b.step"));
  std::ifstream a(folder.File("a.step")), b(folder.File("b.step"));
  const std::string first((std::istreambuf_iterator<char>(a)), {});
  EXPECT_EQ(first, std::string((std::istreambuf_iterator<char>(b)), {}));
}

}  // namespace batten::internal::step_trims_test
