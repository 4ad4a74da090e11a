// SPDX-License-Identifier: MIT
#include "fitting/flattening/sheet_base.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "batten/fitting/solve_linear.h"
#include "bent_sheets.h"
#include "fitting/knots/knot_grid_selection.h"
#include "fitting/least_squares/fitting_bases.h"
#include "tolerances.h"

namespace batten::internal::sheet_base_test {

using ::testing::HasSubstr;

struct Scale {
  double spacing, noise;
  double Margin() const { return spacing / 2 + 2 * noise; }
};

Scale ScaleOf(const Eigen::Matrix3Xd& points, const NeighbourIndex& index, ThreadPool& pool) {
  const CloudStatistics found = MeasureCloud(points, index, {.find_outliers = false}, pool);
  return {found.spacing, found.noise};
}

FlattenedBase FlattenSheet(const Eigen::Matrix3Xd& points,
                           const NeighbourIndex& index,
                           double spacing,
                           double noise,
                           double margin,
                           ThreadPool& pool,
                           const Progress& progress = {}) {
  SheetLayout layout(points, index, spacing, noise, margin, pool, progress);
  layout.LookCloser();
  return layout.Over(points);
}

FlattenedBase Flatten(const Eigen::Matrix3Xd& points, int threads = 2) {
  ThreadPool pool(threads);
  const NeighbourIndex index(points);
  const Scale scale = ScaleOf(points, index, pool);
  return FlattenSheet(points, index, scale.spacing, scale.noise, scale.Margin(), pool);
}

// The rigid motion of the plane, mirrors allowed, that brings `from` nearest to `to`, and the root
// mean square of what is left. [Kabsch 1976]
double RmsAfterMotion(const Eigen::Matrix2Xd& from, const Eigen::Matrix2Xd& to) {
  const Eigen::Matrix2Xd a = from.colwise() - from.rowwise().mean();
  const Eigen::Matrix2Xd b = to.colwise() - to.rowwise().mean();
  const Eigen::JacobiSVD<Eigen::Matrix2d> svd(a * b.transpose(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix2d turn = svd.matrixV() * svd.matrixU().transpose();
  return std::sqrt((turn * a - b).squaredNorm() / static_cast<double>(a.cols()));
}

Eigen::Matrix2Xd FlatPlaces(const BentSheet& sheet, const SheetPoints& cloud) {
  Eigen::Matrix2Xd places(2, cloud.parameters.cols());
  for (Eigen::Index k = 0; k < places.cols(); ++k) {
    places.col(k) = sheet.flat(cloud.parameters(0, k), cloud.parameters(1, k));
  }
  return places;
}

double LongestSide(const FlattenedBase& base) { return std::max(base.length_u, base.length_v); }

void ExpectInside(const FlattenedBase& base) {
  EXPECT_TRUE(base.parameters.allFinite());
  EXPECT_GE(base.parameters.minCoeff(), 0);
  EXPECT_LE(base.parameters.row(0).maxCoeff(), base.length_u);
  EXPECT_LE(base.parameters.row(1).maxCoeff(), base.length_v);
}

std::vector<BentSheet> DevelopableSheets() {
  return {FlatSheet(2, 1),
          ArcSheet(300),
          SBend(),
          Roll(),
          WideningPipe(),
          LShaped(SBend()),
          RingShaped(ArcSheet(220)),
          DiscShaped(Roll(1.2, 0.2))};
}

TEST(FlattenSheetTest, KeepsTheLengthsOfDevelopableSheets) {
  for (const BentSheet& sheet : DevelopableSheets()) {
    for (unsigned seed = 1; seed <= 2; ++seed) {
      SCOPED_TRACE(sheet.name + ", seed " + std::to_string(seed));
      const SheetPoints cloud = PointsOn(sheet, {.count = 5000, .seed = seed});
      const FlattenedBase base = Flatten(cloud.points);
      ASSERT_EQ(base.failure_reason, "");
      ExpectInside(base);
      EXPECT_TRUE(base.reached.all());
      EXPECT_EQ(base.share, 1);
      // Quadrics around nodes are wrong to the fourth order of the reach, in curvatures some
      // permille where nodes are 500.
      EXPECT_LE(base.distortion, 0.01);
      EXPECT_LE(RmsAfterMotion(base.parameters, FlatPlaces(sheet, cloud)),
                2e-3 * LongestSide(base));
    }
  }
}

TEST(FlattenSheetTest, GivesARectangularCloudItsRectangle) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const SheetPoints cloud = PointsOn(SBend(150, 3, 1.2), {.count = 20000, .seed = seed});
    ThreadPool pool(2);
    const NeighbourIndex index(cloud.points);
    const Scale scale = ScaleOf(cloud.points, index, pool);
    const FlattenedBase base =
        FlattenSheet(cloud.points, index, scale.spacing, scale.noise, 0, pool);
    // The last of many random points lies a small part of the spacing inside the edge.
    EXPECT_NEAR(base.length_u, 3, scale.spacing);
    EXPECT_NEAR(base.length_v, 1.2, scale.spacing);
    // Every corner of the domain has a point near it: within 3 spacings are 7 on average.
    for (const double u : {0.0, base.length_u}) {
      for (const double v : {0.0, base.length_v}) {
        EXPECT_LE((base.parameters.colwise() - Eigen::Vector2d(u, v)).colwise().norm().minCoeff(),
                  3 * scale.spacing);
      }
    }
  }
}

TEST(FlattenSheetTest, KeepsItsPromiseForNoise) {
  for (const BentSheet& sheet : DevelopableSheets()) {
    SCOPED_TRACE(sheet.name);
    const SheetPoints cloud =
        PointsOn(sheet, {.count = 8000, .sigma = 5e-3, .isotropic = true, .seed = 3});
    const FlattenedBase base = Flatten(cloud.points);
    ASSERT_EQ(base.failure_reason, "");
    ExpectInside(base);
    // Two components of the noise are along the sheet and belong to the parameters.
    EXPECT_LE(RmsAfterMotion(base.parameters, FlatPlaces(sheet, cloud)),
              1.3 * std::sqrt(2) * 5e-3 + 2e-3 * LongestSide(base));
  }
}

// Determinants of the gradient of a spline through the parameters, at all points.
struct Senses {
  Eigen::Index positive = 0, negative = 0;
};

Senses SensesOf(const FlattenedBase& base,
                const SheetPoints& cloud,
                const BentSheet& sheet,
                ThreadPool& pool) {
  auto data = std::make_shared<FittingData>();
  data->parameters = base.parameters;
  data->values = cloud.points;
  const FittingProblem problem(FittingBasis(3, 16, 0, base.length_u),
                               FittingBasis(3, 16, 0, base.length_v),
                               std::move(data),
                               1e-4);
  const NurbsSurface surface(
      problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool).coefficients);
  Senses senses;
  for (Eigen::Index k = 0; k < cloud.points.cols(); ++k) {
    const auto normal = surface.NormalAt(base.parameters(0, k), base.parameters(1, k));
    const double sense =
        normal ? normal->dot(sheet.NormalAt(cloud.parameters(0, k), cloud.parameters(1, k))) : 0;
    ++(sense > 0 ? senses.positive : senses.negative);
  }
  return senses;
}

TEST(FlattenSheetTest, NeverFolds) {
  ThreadPool pool(2);
  for (const BentSheet& sheet : {ShellSheet(),
                                 SBend(),
                                 Roll(),
                                 WideningPipe(),
                                 SphericalCap(60),
                                 SphericalCap(120),
                                 LShaped(ShellSheet()),
                                 RingShaped(ShellSheet()),
                                 DiscShaped(ShellSheet())}) {
    SCOPED_TRACE(sheet.name);
    const SheetPoints cloud =
        PointsOn(sheet, {.count = 10000, .sigma = 1e-3, .isotropic = true, .seed = 5});
    const FlattenedBase base = Flatten(cloud.points);
    ASSERT_EQ(base.failure_reason, "");
    const Senses senses = SensesOf(base, cloud, sheet, pool);
    EXPECT_EQ(std::min(senses.positive, senses.negative), 0);
  }
}

// Neighbours along the sheet are neighbours in the plane, so that turns were not joined.
TEST(FlattenSheetTest, UnrollsTurnsThatAreThreeAndAHalfSpacingsApart) {
  for (const double apart : {3.5, 4.0, 6.0}) {
    for (unsigned seed = 1; seed <= 2; ++seed) {
      SCOPED_TRACE(std::to_string(apart) + " spacings, seed " + std::to_string(seed));
      const Eigen::Index count = 12000;
      const BentSheet sheet = Roll(1.5, apart * std::sqrt(3.2 / static_cast<double>(count)));
      const SheetPoints cloud =
          PointsOn(sheet, {.count = count, .sigma = 1e-3, .isotropic = true, .seed = seed});
      const FlattenedBase base = Flatten(cloud.points);
      ASSERT_EQ(base.failure_reason, "");
      EXPECT_LE(RmsAfterMotion(base.parameters, FlatPlaces(sheet, cloud)),
                5e-3 * LongestSide(base));
    }
  }
}

TEST(FlattenSheetTest, TellsHowMuchLengthsChangeOnACap) {
  // A cap's area is that of a flat disc of radius 2 sin(angle/2): the greater, the farther from
  // any isometric map.
  double before = 0;
  for (const double angle : {20.0, 40.0, 60.0, 90.0, 120.0}) {
    SCOPED_TRACE("angle " + std::to_string(angle));
    const FlattenedBase base =
        Flatten(PointsOn(SphericalCap(angle), {.count = 4000, .sigma = 1e-3}).points);
    EXPECT_EQ(base.failure_reason, "");
    EXPECT_GT(base.distortion, before);
    before = base.distortion;
  }
  EXPECT_LT(before, 0.35);
}

TEST(FlattenSheetTest, FollowsADensityThatChangesAcrossTheSheet) {
  for (const double density : {10.0, 100.0}) {
    SCOPED_TRACE("density " + std::to_string(density));
    const BentSheet sheet = ArcSheet(240);
    const SheetPoints cloud = PointsOn(sheet, {.count = 10000, .density = density, .seed = 2});
    const FlattenedBase base = Flatten(cloud.points);
    ASSERT_EQ(base.failure_reason, "");
    ExpectInside(base);
    EXPECT_LE(RmsAfterMotion(base.parameters, FlatPlaces(sheet, cloud)), 5e-3 * LongestSide(base));
  }
}

// Spacings from one to a hundred: of 10000 points ten are on the last quarter of the sheet.
TEST(FlattenSheetTest, SurvivesSpacingsThatChangeAHundredfold) {
  for (const BentSheet& sheet : {ArcSheet(240), ShellSheet(), WideningPipe()}) {
    SCOPED_TRACE(sheet.name);
    const FlattenedBase base = Flatten(PointsOn(sheet, {.count = 10000, .density = 1e4}).points);
    EXPECT_EQ(base.failure_reason, "");
    ExpectInside(base);
  }
}

TEST(FlattenSheetTest, RefusesWhatIsNoOpenSheetAndSaysWhy) {
  const struct {
    BentSheet sheet;
    const char* word;
  } cases[] = {{ArcSheet(360), "closed"},
               {SphericalCap(180), "closed"},
               {TorusSheet(), "closed"},
               {TwistedBand(2), "closed"},
               {TwistedBand(1), "one-sided"},
               {TwistedBand(1, 0.3), "one-sided"}};
  for (const auto& [sheet, word] : cases) {
    SCOPED_TRACE(sheet.name);
    const FlattenedBase base =
        Flatten(PointsOn(sheet, {.count = 6000, .sigma = 1e-3, .isotropic = true}).points);
    EXPECT_FALSE(base.ok());
    EXPECT_THAT(base.failure_reason, HasSubstr(word));
    EXPECT_THAT(base.failure_reason, HasSubstr("fit a part"));
    ExpectInside(base);
  }
}

TEST(FlattenSheetTest, RefusesSeveralSheets) {
  const Eigen::Matrix3Xd one = PointsOn(ShellSheet(), {.count = 3000, .sigma = 1e-3}).points;
  Eigen::Matrix3Xd two(3, 5000);
  two.leftCols(3000) = one;
  two.rightCols(2000) = one.leftCols(2000).colwise() + Eigen::Vector3d(4, 0, 0);
  const FlattenedBase base = Flatten(two);
  EXPECT_THAT(base.failure_reason, HasSubstr("several sheets"));
  EXPECT_LT(base.share, 0.9);
  ExpectInside(base);
  // What is not of the main sheet is not reached by it.
  EXPECT_TRUE(base.reached.head(3000).all());
  EXPECT_EQ(base.reached.tail(2000).count(), 0);
}

TEST(FlattenSheetTest, RefusesFewPointsAndPointsOnLines) {
  for (Eigen::Index count = 1; count <= 50; ++count) {
    SCOPED_TRACE(std::to_string(count) + " points");
    const FlattenedBase base =
        Flatten(PointsOn(ArcSheet(120), {.count = count, .sigma = 1e-4}).points);
    ExpectInside(base);
    EXPECT_EQ(base.parameters.cols(), count);
    if (count < 12) {
      EXPECT_THAT(base.failure_reason, HasSubstr("too few points"));
    }
    if (count >= 40) {
      EXPECT_EQ(base.failure_reason, "");
    }
  }
  Eigen::Matrix3Xd line(3, 500);
  for (int k = 0; k < 500; ++k) line.col(k) << std::cos(0.01 * k), std::sin(0.01 * k), 0.002 * k;
  EXPECT_THAT(Flatten(line).failure_reason, HasSubstr("along lines"));
}

TEST(FlattenSheetTest, SurvivesCloudsThatAreNoSheets) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    Eigen::Matrix3Xd points(3, 20 + 97 * round);
    for (double& x : points.reshaped()) x = uniform(engine);
    if (round % 4 == 1) points.row(2) *= 1e-9;
    if (round % 4 == 2) points = (points * 4).array().round().matrix().eval();  // many of one place
    if (round % 4 == 3) points = points.array().cube().cube().matrix().eval();
    ExpectInside(Flatten(points));
  }
}

TEST(FlattenSheetTest, TurnsAndScalesWithTheCloud) {
  const SheetPoints cloud = PointsOn(ShellSheet(), {.count = 6000, .sigma = 1e-3});
  const FlattenedBase base = Flatten(cloud.points);
  for (const double unit : {1e-6, 1.0, 1e6}) {
    SCOPED_TRACE("unit " + std::to_string(unit));
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -2) / 3).toRotationMatrix();
    const Eigen::Matrix3Xd moved =
        unit * ((turn * cloud.points).colwise() + Eigen::Vector3d(300, -500, 20));
    const FlattenedBase other = Flatten(moved);
    ASSERT_EQ(other.failure_reason, "");
    // The order in which nodes are taken depends on the coordinates; other nodes tell the same of
    // the sheet but for what their quadrics leave out.
    EXPECT_LE(RmsAfterMotion(other.parameters / unit, base.parameters), 2e-3 * LongestSide(base));
    EXPECT_NEAR(other.distortion, base.distortion, 0.1 * base.distortion);
  }
}

TEST(FlattenSheetTest, DoesNotDependOnTheOrderOfThePoints) {
  const SheetPoints cloud = PointsOn(ShellSheet(), {.count = 5000, .sigma = 1e-3});
  std::vector<Eigen::Index> order(5000);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937_64(4));
  ThreadPool pool(2);
  const auto flatten = [&](const Eigen::Matrix3Xd& points) {
    return FlattenSheet(points, NeighbourIndex(points), 0.04, 1e-3, 0.02, pool);
  };
  const FlattenedBase base = flatten(cloud.points);
  const FlattenedBase shuffled = flatten(cloud.points(Eigen::all, order));
  EXPECT_NEAR(shuffled.length_u, base.length_u, kIterated);
  EXPECT_LE((shuffled.parameters - base.parameters(Eigen::all, order)).cwiseAbs().maxCoeff(),
            kIterated);
}

TEST(FlattenSheetTest, GivesTheSameBitsForEveryNumberOfThreads) {
  for (const BentSheet& sheet : {ShellSheet(), TorusSheet()}) {
    const Eigen::Matrix3Xd points = PointsOn(sheet, {.count = 6000, .sigma = 1e-3}).points;
    const FlattenedBase one = Flatten(points, 1), three = Flatten(points, 3);
    EXPECT_EQ(one.parameters, three.parameters);
    EXPECT_EQ(one.distortion, three.distortion);
    EXPECT_TRUE((one.reached == three.reached).all());
  }
}

TEST(FlattenSheetTest, PassesOverPointsOffTheSheet) {
  const SheetPoints cloud = PointsOn(ArcSheet(200), {.count = 5000, .sigma = 1e-3});
  Eigen::Matrix3Xd points(3, 5003);
  points.leftCols(5000) = cloud.points;
  points.rightCols(3) << 0, 0.3, 8, 0, 0.2, 8, 0.7, -3, 8;
  const FlattenedBase base = Flatten(points);
  EXPECT_EQ(base.failure_reason, "");
  EXPECT_TRUE(base.reached.head(5000).all());
  EXPECT_FALSE(base.reached.tail(3).any());
  EXPECT_LT(base.length_u, 3.7);  // of 200 degrees: 3.49
  ExpectInside(base);
}

TEST(FlattenSheetTest, ChecksItsArguments) {
  ThreadPool pool(1);
  const Eigen::Matrix3Xd points = PointsOn(FlatSheet(), {.count = 100}).points;
  const NeighbourIndex index(points), other(points.leftCols(50).eval());
  EXPECT_THROW(FlattenSheet(points, other, 0.1, 0, 0.1, pool), std::invalid_argument);
  EXPECT_THROW(FlattenSheet(points, index, -1, 0, 0.1, pool), std::invalid_argument);
  EXPECT_THROW(FlattenSheet(points, index, 0.1, -1, 0.1, pool), std::invalid_argument);
  EXPECT_THROW(FlattenSheet(points, index, 0.1, 0, std::nan(""), pool), std::invalid_argument);
  EXPECT_THROW(
      FlattenSheet(points, index, 0.1, 0, 0, pool, [](const char*, double) { return false; }),
      Cancelled);
}

TEST(SheetLayoutTest, GivesSomePointsThePlacesThatAllGiveThem) {
  ThreadPool pool(2);
  for (const BentSheet& sheet : {ArcSheet(300), SBend(), ShellSheet()}) {
    SCOPED_TRACE(sheet.name);
    const Eigen::Matrix3Xd points = PointsOn(sheet, {.count = 6000, .sigma = 1e-3}).points;
    const NeighbourIndex index(points);
    const Scale scale = ScaleOf(points, index, pool);
    SheetLayout layout(points, index, scale.spacing, scale.noise, scale.Margin(), pool);
    layout.LookCloser();
    const FlattenedBase all = layout.Over(points);
    EXPECT_EQ(all.parameters, Flatten(points).parameters);
    std::vector<Eigen::Index> some(2000);
    for (Eigen::Index k = 0; k < 2000; ++k) some[static_cast<size_t>(k)] = 3 * k;
    const FlattenedBase part = layout.Over(points(Eigen::all, some));
    EXPECT_EQ(part.failure_reason, all.failure_reason);
    EXPECT_EQ(part.distortion, all.distortion);
    EXPECT_TRUE((part.reached == all.reached(some)).all());
    ExpectInside(part);
    // Their rectangle is another one; places that were drawn into it are a guess.
    std::vector<Eigen::Index> laid;
    for (Eigen::Index k = 0; k < 2000; ++k)
      if (part.reached[k]) laid.push_back(k);
    EXPECT_GT(laid.size(), 1900);
    const Eigen::Matrix2Xd of_all = all.parameters(Eigen::all, some);
    EXPECT_LE(RmsAfterMotion(part.parameters(Eigen::all, laid), of_all(Eigen::all, laid)),
              kIterated * LongestSide(all));
  }
}

}  // namespace batten::internal::sheet_base_test
