// SPDX-License-Identifier: MIT
#include "fitting/flattening/tube_base.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "angles.h"
#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/nurbs_surface.h"
#include "fitting/knots/knot_grid_selection.h"
#include "fitting/least_squares/fitting_bases.h"
#include "tubes.h"

namespace batten::internal::tube_base_test {

using ::testing::HasSubstr;

FlattenedBase RollOff(const Eigen::Matrix3Xd& points, int threads = 2) {
  ThreadPool pool(threads);
  const NeighbourIndex index(points);
  const CloudStatistics found = MeasureCloud(points, index, {.find_outliers = false}, pool);
  return FlattenTube(
      points, index, found.spacing, found.noise, found.spacing / 2 + 2 * found.noise, pool);
}

double SizeOf(const BentSheet& sheet) {
  const Eigen::Matrix3Xd points = SheetTruth(sheet, 40);
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
}

// Noise relative to the size; turned in space.
SheetPoints Turned(const BentSheet& sheet, SheetScatter scatter, double relative) {
  scatter.sigma = relative * SizeOf(sheet);
  SheetPoints cloud = PointsOn(sheet, scatter);
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, 3).normalized();
  cloud.points = (Eigen::AngleAxisd(0.7, axis).toRotationMatrix() * cloud.points).eval();
  return cloud;
}

void ExpectInside(const FlattenedBase& base) {
  EXPECT_TRUE(base.parameters.allFinite());
  EXPECT_GE(base.parameters.minCoeff(), 0);
  EXPECT_LT(base.parameters.row(0).maxCoeff(), base.length_u);
  EXPECT_LE(base.parameters.row(1).maxCoeff(), base.length_v);
}

double Nearest(double way, double period) { return way - period * std::round(way / period); }

// In each of so many patches of the true parameters, the sense of the affine map from them to those
// found: how many differ from the others.
int PatchesTurnedOver(const SheetPoints& cloud, const FlattenedBase& base, int side) {
  struct Patch {
    Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 2> rhs = Eigen::Matrix<double, 3, 2>::Zero();
    double first_u = -1;
    int count = 0;
  };
  std::vector<Patch> patches(static_cast<size_t>(side * side));
  for (Eigen::Index k = 0; k < cloud.points.cols(); ++k) {
    const double u = cloud.parameters(0, k), v = cloud.parameters(1, k);
    const int i = std::min(side - 1, static_cast<int>(u * side));
    const int j = std::min(side - 1, static_cast<int>(v * side));
    Patch& patch = patches[i * side + j];
    if (patch.count++ == 0) patch.first_u = base.parameters(0, k);
    const Eigen::Vector3d row(1, u * side - i, v * side - j);
    const Eigen::RowVector2d place(Nearest(base.parameters(0, k) - patch.first_u, base.length_u),
                                   base.parameters(1, k));
    patch.gram += row * row.transpose();
    patch.rhs += row * place;
  }
  int left = 0, right = 0;
  for (const Patch& patch : patches) {
    if (patch.count < 8) continue;
    const Eigen::Matrix<double, 3, 2> map = patch.gram.ldlt().solve(patch.rhs);
    ++(map(1, 0) * map(2, 1) > map(1, 1) * map(2, 0) ? left : right);
  }
  return std::min(left, right);
}

SplineBasis Round(int cells, double period) {
  std::vector<double> knots;
  for (int i = -3; i <= cells + 3; ++i) knots.push_back(period * i / cells);
  return SplineBasis::Periodic(3, std::move(knots));
}

struct ChosenFit {
  double rms;    // against the truth
  int unknowns;  // control points that differ
};

// Over the bicubic grid, closed round, of least generalised cross-validation: nearly square cells
// from coarse to fine, then each direction alone.
ChosenFit FitOver(const Eigen::Matrix2Xd& parameters,
                  double length_u,
                  double length_v,
                  const Eigen::Matrix3Xd& points,
                  const Eigen::Matrix3Xd& truth) {
  ThreadPool pool(2);
  auto data = std::make_shared<FittingData>();
  data->parameters = parameters;
  data->values = points;
  const FittingProblem start(Round(4, length_u), FittingBasis(3, 1, 0, length_v), data, 1e-4);
  const auto count = static_cast<double>(points.cols());
  const auto problem = [&](std::pair<int, int> cells) {
    return start.WithBases(Round(cells.first, length_u),
                           FittingBasis(3, cells.second, 0, length_v));
  };
  const auto score = [&](std::pair<int, int> cells) {
    const double free = count - kFreedomFactor * cells.first * (cells.second + 3);
    if (free < count / 2) return std::numeric_limits<double>::infinity();
    return SolveLinear(problem(cells), pool).residual_squares / (free * free);
  };
  std::pair<int, int> best{4, 1};
  double least = score(best);
  const auto try_cells = [&](std::pair<int, int> cells) {
    if (cells.first < 4 || cells.second < 1) return false;
    const double now = score(cells);
    if (now >= least) return false;
    least = now;
    best = cells;
    return true;
  };
  int failures = 0;
  for (int cells = 5; failures < 3 && cells < 60; cells = cells * 6 / 5 + 1) {
    const double along = cells * length_v / length_u;
    failures =
        try_cells({cells, std::max(1, static_cast<int>(std::lround(along)))}) ? 0 : failures + 1;
  }
  for (bool moved = true; moved;) {
    moved = false;
    for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      if (try_cells({best.first + du, best.second + dv})) moved = true;
    }
  }
  const FittingProblem chosen = problem(best);
  const NurbsSurface surface(
      chosen.basis_u(), chosen.basis_v(), SolveLinear(chosen, pool).coefficients);
  const Eigen::VectorXd d = DistancesTo(surface, truth, pool).distances;
  return {std::sqrt(d.squaredNorm() / static_cast<double>(d.size())),
          best.first * (best.second + 3)};
}

TEST(FlattenTubeTest, GivesACylinderItsAngleAndItsLength) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const SheetPoints cloud = Turned(StraightTube(5), {.count = 6000, .seed = seed}, 0);
    const FlattenedBase base = RollOff(cloud.points);
    ASSERT_EQ(base.failure_reason, "");
    ExpectInside(base);
    EXPECT_TRUE(base.reached.all());
    // Quadrics around nodes are wrong to the fourth order of their reach, some permille.
    EXPECT_NEAR(base.length_u, 2 * kPi, 0.01);
    EXPECT_LE(base.distortion, 0.01);
    // Either handedness of the true parameters; the seam is anywhere.
    double least = std::numeric_limits<double>::infinity();
    for (const double sign : {1.0, -1.0}) {
      double sine = 0, cosine = 0;
      for (Eigen::Index k = 0; k < cloud.points.cols(); ++k) {
        const double way =
            2 * kPi * (base.parameters(0, k) / base.length_u - sign * cloud.parameters(0, k));
        sine += std::sin(way);
        cosine += std::cos(way);
      }
      const double resultant = std::hypot(sine, cosine) / static_cast<double>(cloud.points.cols());
      least = std::min(least, std::sqrt(2 * std::max(0.0, 1 - resultant)));  // root mean square
    }
    EXPECT_LE(least, 0.01);
    const Eigen::ArrayXd v = base.parameters.row(1).transpose(),
                         z = 5 * cloud.parameters.row(1).transpose();
    const Eigen::ArrayXd a = v - v.mean(), b = z - z.mean();
    EXPECT_NEAR(std::abs((a * b).mean()) / b.square().mean(), 1, 0.01);
    EXPECT_GE(std::abs((a * b).mean()), 0.9999 * std::sqrt(a.square().mean() * b.square().mean()));
  }
}

// A pipe bent in a circle is covered by both its angles: they meet at right angles, and each is a
// function of nothing else.
TEST(FlattenTubeTest, GivesElbowsTheAnglesRoundThePipeAndRoundTheBend) {
  for (const double degrees : {90.0, 200.0}) {
    SCOPED_TRACE(degrees);
    const SheetPoints cloud = Turned(Elbow(degrees), {.count = 20000, .seed = 5}, 1e-3);
    const FlattenedBase base = RollOff(cloud.points);
    ASSERT_EQ(base.failure_reason, "");
    ExpectInside(base);
    EXPECT_NEAR(base.length_u, 2 * kPi, 0.01);
    const Eigen::ArrayXd v = base.parameters.row(1).transpose(),
                         t = cloud.parameters.row(1).transpose();
    const Eigen::ArrayXd a = v - v.mean(), b = t - t.mean();
    const double slope = (a * b).mean() / b.square().mean();
    // ∫ (a |∇θ| − 1)² over the pipe, |∇θ| = 1/(R + r cos φ), is least for a = √(R² − r²); the
    // margins stretch it by some permille.
    EXPECT_NEAR(
        std::abs(slope), std::sqrt(2.5 * 2.5 - 1) * degrees * kPi / 180, 0.01 * std::abs(slope));
    EXPECT_LE(std::sqrt((a - slope * b).square().mean()), 0.005 * std::abs(slope));
  }
}

std::vector<BentSheet> Tubes() {
  BentSheet window = Elbow(200);
  window.name += " with a window";
  window.inside = [](double u, double v) {
    return std::hypot(6.3 * (u - 0.3), 8.7 * (v - 0.5)) > 0.4;
  };
  BentSheet holes = Elbow(200);
  holes.name += " full of holes";
  holes.inside = [](double u, double v) {
    return std::hypot(std::fmod(6 * u, 1) - 0.5, std::fmod(8 * v, 1) - 0.5) > 0.25;
  };
  BentSheet oblique = Elbow(90);
  oblique.name += ", cut obliquely";
  oblique.inside = [](double u, double v) { return v > 0.15 + 0.12 * std::cos(2 * kPi * u); };
  BentSheet ragged = Elbow(90);
  ragged.name += ", torn off";
  ragged.inside = [](double u, double v) {
    return v > 0.1 + 0.05 * std::sin(34 * kPi * u) * std::cos(10 * kPi * u);
  };
  return {StraightTube(5),
          StraightTube(4, 1.5, 0.5),
          StraightTube(60),
          Elbow(90),
          Elbow(200),
          Elbow(90, 1.5),
          Coil(3),
          Hose(),
          Horn(),
          TwistedBand(0),
          TwistedBand(2),
          window,
          holes,
          oblique,
          ragged};
}

TEST(FlattenTubeTest, RollsOffWhatIsATubeOnceAndNowhereTurnedOver) {
  for (const BentSheet& sheet : Tubes()) {
    SCOPED_TRACE(sheet.name);
    const SheetPoints cloud = Turned(sheet, {.count = 20000, .seed = 2}, 5e-4);
    const FlattenedBase base = RollOff(cloud.points);
    ASSERT_EQ(base.failure_reason, "");
    ExpectInside(base);
    EXPECT_EQ(base.orientation_consistent, true);
    EXPECT_GE(base.reached.cast<double>().mean(), 0.999);
    EXPECT_EQ(PatchesTurnedOver(cloud, base, 12), 0);
  }
}

// (u, v, outwards) is right-handed: on a cylinder about z, v grows with z and u with the angle or
// both against it.
TEST(FlattenTubeTest, RunsRoundSoThatNormalsLookOutwards) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const SheetPoints cloud = PointsOn(StraightTube(4), {.count = 3000, .seed = seed});
    const FlattenedBase base = RollOff(cloud.points);
    ASSERT_EQ(base.failure_reason, "");
    double turn = 0, rise = 0;
    const double middle = base.parameters.row(1).mean();
    for (Eigen::Index k = 1; k < cloud.points.cols(); ++k) {
      const double way = Nearest(base.parameters(0, k) - base.parameters(0, 0), base.length_u);
      const double true_way = Nearest(cloud.parameters(0, k) - cloud.parameters(0, 0), 1);
      turn += way * true_way;
      rise += (base.parameters(1, k) - middle) * (cloud.parameters(1, k) - 0.5);
    }
    EXPECT_GT(turn * rise, 0);
    EXPECT_GT(rise, 0);  // along the coordinate it has most to do with
  }
}

TEST(FlattenTubeTest, LaysPlaneEndsOnStraightLines) {
  const SheetPoints cloud = Turned(Elbow(200), {.count = 20000, .seed = 3}, 1e-3);
  const FlattenedBase base = RollOff(cloud.points);
  ASSERT_EQ(base.failure_reason, "");
  const bool along =
      cloud.parameters.row(1).dot(
          (base.parameters.row(1).array() - base.parameters.row(1).mean()).matrix()) > 0;
  double squares = 0;
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < cloud.points.cols(); ++k) {
    const double from_end =
        base.length_v * (along ? cloud.parameters(1, k) : 1 - cloud.parameters(1, k));
    if (from_end > 0.1) continue;
    squares += std::pow(base.parameters(1, k) - from_end, 2);
    ++count;
  }
  ASSERT_GT(count, 100);
  // The margin is half a spacing (0.05) and two deviations of the noise, 0.04 in all.
  EXPECT_LE(std::sqrt(squares / static_cast<double>(count)), 0.06);
}

struct Ratios {
  double to_limit = 0, to_true = 0;  // squared errors, against σ²n/N and the fit over true angles
};

Ratios FitOfElbow(double degrees, Eigen::Index count, unsigned seed) {
  const BentSheet sheet = Elbow(degrees);
  SCOPED_TRACE(sheet.name + ", seed " + std::to_string(seed));
  const double sigma = 1e-3 * SizeOf(sheet);
  const SheetPoints cloud = PointsOn(sheet, {.count = count, .sigma = sigma, .seed = seed});
  const FlattenedBase base = RollOff(cloud.points);
  EXPECT_EQ(base.failure_reason, "");
  const Eigen::Matrix3Xd truth = SheetTruth(sheet, 80);
  const ChosenFit fit = FitOver(base.parameters, base.length_u, base.length_v, cloud.points, truth);
  const Eigen::Matrix2Xd exact =
      Eigen::Vector2d(base.length_u, base.length_v).asDiagonal() * cloud.parameters;
  const ChosenFit best = FitOver(exact, base.length_u, base.length_v, cloud.points, truth);
  return {fit.rms * fit.rms * static_cast<double>(count) / (sigma * sigma * fit.unknowns),
          fit.rms * fit.rms / (best.rms * best.rms)};
}

constexpr double kToLimit = 1.2;

TEST(FlattenTubeTest, BringsFitsOfElbowsToTheLimit) {
  for (const double degrees : {90.0, 200.0}) {
    const Ratios ratios = FitOfElbow(degrees, 20000, 1);
    EXPECT_LE(std::sqrt(ratios.to_limit), kToLimit);
    EXPECT_LE(std::sqrt(ratios.to_true), kToLimit);
  }
}

TEST(FlattenTubeTest, StandsThickNoiseAndUnevenDensity) {
  for (const BentSheet& sheet : {StraightTube(5), Elbow(90), Elbow(200), Hose()}) {
    SCOPED_TRACE(sheet.name);
    const SheetPoints thick = Turned(sheet, {.count = 10000, .isotropic = true, .seed = 4}, 6e-3);
    const FlattenedBase noisy = RollOff(thick.points);
    ASSERT_EQ(noisy.failure_reason, "");
    ExpectInside(noisy);
    EXPECT_EQ(PatchesTurnedOver(thick, noisy, 8), 0);
    const SheetPoints uneven = Turned(sheet, {.count = 20000, .density = 10, .seed = 4}, 1e-3);
    const FlattenedBase base = RollOff(uneven.points);
    ASSERT_EQ(base.failure_reason, "");
    ExpectInside(base);
    EXPECT_EQ(PatchesTurnedOver(uneven, base, 8), 0);
  }
}

// Tubes of 1000 points and of few.
TEST(FlattenTubeTest, ServesOrRefusesFewPointsButNeverBreaks) {
  for (const Eigen::Index count : {1, 2, 5, 30, 100, 300, 1000}) {
    SCOPED_TRACE(std::to_string(count) + " points");
    const SheetPoints cloud = PointsOn(StraightTube(5), {.count = count, .seed = 6});
    const FlattenedBase base = RollOff(cloud.points);
    EXPECT_TRUE(base.parameters.allFinite());
    EXPECT_EQ(base.parameters.cols(), count);
    EXPECT_GE(base.parameters.minCoeff(), 0);
    EXPECT_LE(base.parameters.row(0).maxCoeff(), base.length_u);
    EXPECT_LE(base.parameters.row(1).maxCoeff(), base.length_v);
    EXPECT_EQ(base.ok(), base.failure_reason.empty());
    if (count >= 1000) {
      EXPECT_EQ(base.failure_reason, "");
    }
    if (count <= 30) {
      EXPECT_THAT(base.failure_reason, HasSubstr("too few points"));
    }
  }
}

// A pipe with another one standing on it, open inside.
Eigen::Matrix3Xd BranchedPipe(Eigen::Index count) {
  const BentSheet main = StraightTube(6), branch = StraightTube(3, 0.8, 0.8);
  const Eigen::Matrix3Xd along = PointsOn(main, {.count = count, .seed = 8}).points;
  const Eigen::Matrix3Xd up = PointsOn(branch, {.count = count / 2, .seed = 9}).points;
  std::vector<Eigen::Vector3d> kept;
  for (const auto p : along.colwise()) {
    const Eigen::Vector3d q(p[2] - 3, p[1], p[0]);
    if (q[2] < 0 || std::hypot(q[0], q[1]) > 0.8) kept.push_back(q);
  }
  for (const auto q : up.colwise()) {
    if (std::hypot(q[1], q[2]) > 1) kept.emplace_back(q);
  }
  return Eigen::Map<Eigen::Matrix3Xd>(
      kept.data()->data(), 3, static_cast<Eigen::Index>(kept.size()));
}

TEST(FlattenTubeTest, RefusesWhatIsNoTubeAndSaysWhy) {
  const struct {
    BentSheet sheet;
    const char* word;
  } cases[] = {{FlatSheet(2, 1), "does not close round"},
               {ShellSheet(), "does not close round"},
               {ArcSheet(300), "does not close round"},
               {Roll(), "does not close round"},
               {SphericalCap(120), "does not close round"},
               {SphericalCap(180), "one NURBS surface cannot cover"},
               {TorusSheet(0.4), "one NURBS surface cannot cover"},
               {TorusSheet(0.15), "one NURBS surface cannot cover"},
               {TwistedBand(1), "one-sided"},
               {TwistedBand(3), "one-sided"}};
  for (const auto& [sheet, word] : cases) {
    SCOPED_TRACE(sheet.name);
    const FlattenedBase base = RollOff(Turned(sheet, {.count = 10000, .seed = 3}, 1e-3).points);
    EXPECT_THAT(base.failure_reason, HasSubstr(word));
    EXPECT_TRUE(base.parameters.allFinite());
  }
  EXPECT_THAT(RollOff(BranchedPipe(16000)).failure_reason, HasSubstr("branches"));
  Eigen::Matrix3Xd two = PointsOn(Elbow(90), {.count = 8000, .seed = 1}).points;
  two.rightCols(4000).colwise() += Eigen::Vector3d(0, 0, 5);
  EXPECT_THAT(RollOff(two).failure_reason, HasSubstr("one part of the cloud at a time"));
}

TEST(FlattenTubeTest, IsTheSameBitByBitForEveryNumberOfThreads) {
  const SheetPoints cloud = Turned(Hose(), {.count = 12000, .seed = 7}, 1e-3);
  const FlattenedBase one = RollOff(cloud.points, 1), four = RollOff(cloud.points, 4);
  ASSERT_EQ(one.failure_reason, "");
  EXPECT_EQ(one.parameters, four.parameters);
  EXPECT_EQ(one.length_u, four.length_u);
  EXPECT_EQ(one.length_v, four.length_v);
}

// Coordinates choose the nodes, so others are taken where the scale is another.
TEST(FlattenTubeTest, ScalesWithTheCloud) {
  constexpr double kOtherNodes = 5e-3;
  const SheetPoints cloud = Turned(Elbow(90), {.count = 6000, .seed = 7}, 1e-3);
  const FlattenedBase base = RollOff(cloud.points);
  ASSERT_EQ(base.failure_reason, "");
  for (const double scale : {1e-6, 1e6}) {
    SCOPED_TRACE(scale);
    const FlattenedBase scaled = RollOff(scale * cloud.points);
    ASSERT_EQ(scaled.failure_reason, "");
    EXPECT_NEAR(scaled.length_u / scale, base.length_u, kOtherNodes * base.length_u);
    EXPECT_NEAR(scaled.length_v / scale, base.length_v, kOtherNodes * base.length_v);
    EXPECT_NEAR(scaled.distortion, base.distortion, kOtherNodes);
  }
}

TEST(FlattenTubeTest, ThrowsOnArgumentsThatDoNotFit) {
  ThreadPool pool(1);
  const Eigen::Matrix3Xd points = PointsOn(StraightTube(3), {.count = 200}).points;
  const NeighbourIndex index(points), other(points.leftCols(100));
  EXPECT_THROW(FlattenTube(Eigen::Matrix3Xd(3, 0), index, 1, 0, 0, pool), std::invalid_argument);
  EXPECT_THROW(FlattenTube(points, other, 1, 0, 0, pool), std::invalid_argument);
  EXPECT_THROW(FlattenTube(points, index, -1, 0, 0, pool), std::invalid_argument);
  EXPECT_THROW(FlattenTube(points, index, 1, -1, 0, pool), std::invalid_argument);
  EXPECT_THROW(FlattenTube(points, index, 1, 0, -1, pool), std::invalid_argument);
}

// Now and then cross-validation takes a grid too coarse for one cloud, over true angles too: the
// figure is held by the root mean square over several.
TEST(LongFlattenTubeTest, BringsFitsOfElbowsToTheLimit) {
  constexpr int kSeeds = 6;
  for (const double degrees : {90.0, 200.0}) {
    for (const Eigen::Index count : {20000, 40000}) {
      SCOPED_TRACE(std::to_string(degrees) + ", " + std::to_string(count) + " points");
      Ratios mean;
      for (unsigned seed = 1; seed <= kSeeds; ++seed) {
        const Ratios ratios = FitOfElbow(degrees, count, seed);
        mean.to_limit += ratios.to_limit / kSeeds;
        mean.to_true += ratios.to_true / kSeeds;
      }
      EXPECT_LE(std::sqrt(mean.to_limit), kToLimit);
      EXPECT_LE(std::sqrt(mean.to_true), kToLimit);
    }
  }
}

TEST(LongFlattenTubeTest, RollsOffEveryTubeFromManySeeds) {
  for (const BentSheet& sheet : Tubes()) {
    for (unsigned seed = 11; seed <= 20; ++seed) {
      SCOPED_TRACE(sheet.name + ", seed " + std::to_string(seed));
      const SheetPoints cloud = Turned(sheet, {.count = 20000, .seed = seed}, 1e-3);
      const FlattenedBase base = RollOff(cloud.points);
      EXPECT_EQ(base.failure_reason, "");
      if (base.ok()) {
        EXPECT_EQ(PatchesTurnedOver(cloud, base, 12), 0);
      }
    }
  }
}

}  // namespace batten::internal::tube_base_test
