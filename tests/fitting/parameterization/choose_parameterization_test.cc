// SPDX-License-Identifier: MIT
#include "fitting/parameterization/choose_parameterization.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bent_sheets.h"
#include "known_clouds.h"
#include "tolerances.h"

namespace batten::internal::choose_parameterization_test {

using ::testing::HasSubstr;
using ::testing::Not;

ParameterizationChoice Choose(const Eigen::Matrix3Xd& points,
                              BaseShape shape = BaseShape::kAuto,
                              int threads = 2) {
  ThreadPool pool(threads);
  const NeighbourIndex index(points);
  SurfaceFitOptions options;
  options.base = shape;
  return ChooseBase(
      PointCloud(points), index, MeasureCloud(points, index, {}, pool), options, pool);
}

// The sentence it is refused with; empty where it is not.
std::string RefusalOf(const Eigen::Matrix3Xd& points, BaseShape shape = BaseShape::kAuto) {
  try {
    Choose(points, shape);
    return "";
  } catch (const std::invalid_argument& refusal) {
    return refusal.what();
  }
}

SheetPoints NoisyPoints(const BentSheet& sheet, Eigen::Index count = 2500, unsigned seed = 1) {
  return PointsOn(sheet, {.count = count, .sigma = 1e-3, .isotropic = true, .seed = seed});
}

void ExpectPlaces(const ParameterizationChoice& choice, Eigen::Index count) {
  ASSERT_EQ(choice.base.parameters.cols(), count);
  ASSERT_EQ(choice.reached.size(), count);
  EXPECT_TRUE(choice.base.parameters.allFinite());
  EXPECT_GE(choice.base.parameters.minCoeff(), 0);
  EXPECT_LE(choice.base.parameters.row(0).maxCoeff(), choice.base.length_u);
  EXPECT_LE(choice.base.parameters.row(1).maxCoeff(), choice.base.length_v);
  EXPECT_FALSE(choice.base.exact);
  EXPECT_EQ(choice.base.plane.has_value(), choice.base.name == "plane");
}

// A plane misses an exact cap along its rim only, by little: that is no outlier's doing. What is
// not part of a sphere is laid out flat.
TEST(ChooseBaseTest, LeavesThePlaneForAnExactCap) {
  Eigen::Matrix3Xd cap =
      PointsOn(SphericalCap(60), {.count = 5000, .sigma = 0, .isotropic = true, .seed = 3}).points;
  EXPECT_EQ(Choose(cap).base.name, "sphere");
  EXPECT_EQ(Choose(cap, BaseShape::kSheet).base.name, "sheet");
  cap = Eigen::Vector3d(1.6, 1, 0.8).asDiagonal() * cap;
  EXPECT_EQ(Choose(cap).base.name, "sheet");
}

TEST(ChooseBaseTest, TakesThePlaneOfAHeightField) {
  const std::pair<BentSheet, const char*> cases[] = {
      {FlatSheet(2, 1), "inclined 1 degrees or less"},
      {ArcSheet(80), "or less"},
      {SphericalCap(40), "or less"},
      {LShaped(ArcSheet(70)), "or less"},
      {RingShaped(FlatSheet(2, 1)), "or less"}};
  for (const auto& [sheet, why] : cases) {
    SCOPED_TRACE(sheet.name);
    const Eigen::Matrix3Xd points = NoisyPoints(sheet).points;
    const ParameterizationChoice choice = Choose(points);
    ExpectPlaces(choice, points.cols());
    EXPECT_EQ(choice.base.name, "plane");
    EXPECT_THAT(choice.base.why, HasSubstr("height field"));
    EXPECT_THAT(choice.base.why, HasSubstr(why));
    EXPECT_TRUE(choice.reached.all());
    EXPECT_TRUE(choice.warnings.empty());
    const Eigen::Matrix3Xd local = choice.base.plane->ToFrame(points);
    EXPECT_LE((local.topRows<2>() - choice.base.parameters).cwiseAbs().maxCoeff(), kRounding);
  }
}

// Steep in places, but as well foreseen over its plan as laid out flat.
TEST(ChooseBaseTest, TakesThePlaneOfSteepAndOfRoughGround) {
  const auto waves = [](double x, double y) { return 0.2 * std::sin(20 * x) * std::cos(16 * y); };
  for (const auto& points : {Scatter(Franke, 3000, 2e-3, 0, 2),
                             Scatter(Franke, 3000, 0.02, 0, 2),
                             Scatter(waves, 3000, 1e-3, 0, 2)}) {
    const ParameterizationChoice choice = Choose(points);
    ExpectPlaces(choice, 3000);
    EXPECT_EQ(choice.base.name, "plane");
    EXPECT_TRUE(choice.warnings.empty());
    EXPECT_NEAR(std::abs(choice.base.plane->axes(2, 2)), 1, kRounding);
  }
}

TEST(ChooseBaseTest, TakesTheSheetOfWhatNoPlaneSeesWhole) {
  for (const BentSheet& sheet : {ShellSheet(), ArcSheet(300), SBend(200), Roll()}) {
    SCOPED_TRACE(sheet.name);
    const SheetPoints cloud = NoisyPoints(sheet);
    const ParameterizationChoice choice = Choose(cloud.points);
    ExpectPlaces(choice, cloud.points.cols());
    EXPECT_EQ(choice.base.name, "sheet");
    EXPECT_THAT(choice.base.why, HasSubstr("seen from any side"));
    EXPECT_TRUE(choice.warnings.empty());
    EXPECT_TRUE(choice.reached.all());
  }
}

TEST(ChooseBaseTest, RefusesWhatNoBaseServes) {
  EXPECT_THAT(RefusalOf(NoisyPoints(TwistedBand(1)).points), HasSubstr("one-sided"));
  EXPECT_THAT(RefusalOf(NoisyPoints(TwistedBand(1)).points, BaseShape::kSheet),
              HasSubstr("one-sided"));
  // A sheet with its edges joined is a tube, not a ball or a ring.
  for (const BentSheet& sheet : {SphericalCap(180), TorusSheet()}) {
    SCOPED_TRACE(sheet.name);
    EXPECT_THAT(RefusalOf(NoisyPoints(sheet).points, BaseShape::kSheet), HasSubstr("closed"));
  }
  // Closed ones and rolls are layers over every plane.
  for (const BentSheet& sheet : {ArcSheet(360), Roll()}) {
    SCOPED_TRACE(sheet.name);
    EXPECT_THAT(RefusalOf(NoisyPoints(sheet).points, BaseShape::kPlane),
                HasSubstr("not a height field over a plane"));
  }
}

TEST(ChooseBaseTest, RefusesPartsFarApartWhateverTheBase) {
  Eigen::Matrix3Xd points = NoisyPoints(FlatSheet(1, 1)).points;
  for (const double share : {0.3, 0.05}) {
    SCOPED_TRACE("share " + std::to_string(share));
    Eigen::Matrix3Xd parts = points;
    parts.leftCols(static_cast<Eigen::Index>(share * 2500)).colwise() +=
        Eigen::Vector3d(30, 9, 0.1);
    for (const BaseShape shape : {BaseShape::kAuto, BaseShape::kPlane, BaseShape::kSheet}) {
      if (share > 0.1) {
        EXPECT_THAT(RefusalOf(parts, shape), HasSubstr("30 % of the points lie far apart"));
      } else if (shape != BaseShape::kSheet) {
        EXPECT_EQ(RefusalOf(parts, shape), "");
      }
    }
  }
}

// Few points make parts as well as many do.
TEST(ChooseBaseTest, RefusesPartsOfFewPointsFarApart) {
  for (const Eigen::Index count : {12, 20, 29}) {
    SCOPED_TRACE(count);
    Eigen::Matrix3Xd points = NoisyPoints(FlatSheet(1, 1)).points.leftCols(3 * count).eval();
    points.rightCols(count).colwise() += Eigen::Vector3d(30, 9, 0.1);
    EXPECT_THAT(RefusalOf(points, BaseShape::kPlane),
                HasSubstr("33 % of the points lie far apart"));
  }
}

// Lines of a scanner and stations of a hull far apart for their points, pieces with gaps between
// them, and strays are none.
TEST(ChooseBaseTest, RefusesNoPartsThatAreNotFarApart) {
  struct Lines {
    int count, points;
    double step, gap;
  };
  for (const Lines& lines : {Lines{40, 60, 1, 30}, {26, 35, 0.05, 1.58}, {27, 24, 0.07, 1.39}}) {
    SCOPED_TRACE(std::to_string(lines.count) + " lines " + std::to_string(lines.gap) + " apart");
    Eigen::Matrix3Xd points(3, lines.count * lines.points);
    for (int k = 0; k < points.cols(); ++k)
      points.col(k) << lines.step * (k % lines.points), lines.gap * (k / lines.points), 0;
    EXPECT_EQ(RefusalOf(points, BaseShape::kPlane), "");
  }
  Eigen::Matrix3Xd pieces = NoisyPoints(FlatSheet(1, 1)).points;
  for (auto p : pieces.colwise()) p[0] = 1.5 * p[0] + std::floor(3 * p[0]);
  EXPECT_EQ(RefusalOf(pieces, BaseShape::kPlane), "");
  Eigen::Matrix3Xd strays = NoisyPoints(FlatSheet(1, 1)).points;
  for (Eigen::Index k = 0; k < strays.cols(); k += 8)
    strays.col(k).head<2>() += Eigen::Vector2d(40 + k, 3 * k % 700);
  EXPECT_THAT(RefusalOf(strays, BaseShape::kPlane), Not(HasSubstr("far apart")));
}

TEST(ChooseBaseTest, TakesTheBaseItIsTold) {
  const Eigen::Matrix3Xd gentle = NoisyPoints(ArcSheet(70)).points;
  const ParameterizationChoice sheet = Choose(gentle, BaseShape::kSheet);
  ExpectPlaces(sheet, gentle.cols());
  EXPECT_EQ(sheet.base.name, "sheet");
  EXPECT_THAT(sheet.base.why, HasSubstr("asked for"));
  const Eigen::Matrix3Xd bent = NoisyPoints(ArcSheet(150)).points;
  const ParameterizationChoice plane = Choose(bent, BaseShape::kPlane);
  ExpectPlaces(plane, bent.cols());
  EXPECT_EQ(plane.base.name, "plane");
  EXPECT_EQ(plane.base.why, "asked for");
}

TEST(ChooseBaseTest, WarnsOfLayersHereAndThere) {
  // A tenth of a flat sheet lies under a lid that hangs together with nothing.
  Eigen::Matrix3Xd points = NoisyPoints(FlatSheet(2, 1), 4000).points;
  Eigen::Index lid = 0;
  for (Eigen::Index k = 0; k < 4000; k += 2) {
    if (points(0, k) < 0.2) {
      points(2, k) += 0.5;
      ++lid;
    }
  }
  ASSERT_GT(lid, 100);
  for (const BaseShape shape : {BaseShape::kPlane, BaseShape::kAuto}) {
    const ParameterizationChoice choice = Choose(points, shape);
    EXPECT_EQ(choice.base.name, "plane");
    ASSERT_EQ(choice.warnings.size(), 1);
    EXPECT_THAT(choice.warnings[0], HasSubstr("between the layers"));
  }
}

TEST(ChooseBaseTest, PointsThatTheSheetDoesNotReachAreTold) {
  SheetPoints cloud = NoisyPoints(ArcSheet(220));
  const PointMask torn_off = cloud.parameters.row(0).transpose().array() < 0.05;
  for (Eigen::Index k = 0; k < 2500; ++k)
    if (torn_off[k]) cloud.points.col(k) += Eigen::Vector3d(0.2, 0.1, 4);
  const ParameterizationChoice choice = Choose(cloud.points);
  ExpectPlaces(choice, 2500);
  EXPECT_EQ(choice.base.name, "sheet");
  EXPECT_TRUE((choice.reached == !torn_off).all());
}

TEST(ChooseBaseTest, OutliersGetAPlaceButHaveNoSay) {
  for (const BentSheet& sheet : {ArcSheet(70), ArcSheet(220)}) {
    SCOPED_TRACE(sheet.name);
    const Eigen::Matrix3Xd good = NoisyPoints(sheet).points;
    Eigen::Matrix3Xd points(3, 2503);
    points << good, Eigen::Matrix3d{{0.2, 0.3, -5}, {-0.1, 0.2, 5}, {0.5, 9, 0.3}};
    const ParameterizationChoice choice = Choose(points), clean = Choose(good);
    ExpectPlaces(choice, 2503);
    EXPECT_EQ(choice.base.name, clean.base.name);
    EXPECT_TRUE(choice.reached.head(2500).all());
    if (choice.base.name == "sheet") {
      EXPECT_FALSE(choice.reached.tail(3).any());
    }
    EXPECT_NEAR(choice.base.length_u, clean.base.length_u, 0.01 * clean.base.length_u);
    EXPECT_NEAR(choice.base.length_v, clean.base.length_v, 0.01 * clean.base.length_v);
  }
}

TEST(ChooseBaseTest, ChoosesTheSameInEveryUnitAndPlace) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -2) / 3).toRotationMatrix();
  for (const BentSheet& sheet : {SphericalCap(35), ShellSheet()}) {
    const Eigen::Matrix3Xd points = NoisyPoints(sheet, 2000).points;
    const ParameterizationChoice one = Choose(points);
    for (const double unit : {1e-6, 1e6}) {
      SCOPED_TRACE(sheet.name + ", unit " + std::to_string(unit));
      const Eigen::Matrix3Xd moved =
          unit * ((turn * points).colwise() + Eigen::Vector3d(30, -50, 2));
      const ParameterizationChoice other = Choose(moved);
      ExpectPlaces(other, 2000);
      EXPECT_EQ(other.base.name, one.base.name);
      // Other samples of normals or nodes tell the same but for what their quadrics leave out.
      EXPECT_NEAR(other.base.length_u * other.base.length_v / (unit * unit),
                  one.base.length_u * one.base.length_v,
                  0.03 * one.base.length_u * one.base.length_v);
    }
  }
}

TEST(ChooseBaseTest, GivesTheSameBitsForEveryNumberOfThreads) {
  for (const BentSheet& sheet : {SphericalCap(35), ShellSheet()}) {
    SCOPED_TRACE(sheet.name);
    const Eigen::Matrix3Xd points = NoisyPoints(sheet, 2000).points;
    const ParameterizationChoice one = Choose(points, BaseShape::kAuto, 1);
    const ParameterizationChoice three = Choose(points, BaseShape::kAuto, 3);
    EXPECT_EQ(one.base.parameters, three.base.parameters);
    EXPECT_EQ(one.base.why, three.base.why);
    EXPECT_TRUE((one.reached == three.reached).all());
  }
}

}  // namespace batten::internal::choose_parameterization_test
