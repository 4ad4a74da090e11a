// SPDX-License-Identifier: MIT
// Whole fits: what a user relies on, on clouds whose truth is known.
#include "batten/fitting/fit_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/fitting/sample_geometry.h"
#include "fitting/surface/surface_folds.h"
#include "known_clouds.h"

namespace batten::internal::fit_surface_test {

constexpr double kSigma = 1e-3;

struct TruthError {
  double rms, max;
};

TruthError ErrorToTruth(const NurbsSurface& surface, const Eigen::Matrix3Xd& truth) {
  ThreadPool pool(2);
  const Eigen::VectorXd d = DistancesTo(surface, truth, pool).distances;
  return {std::sqrt(d.squaredNorm() / static_cast<double>(d.size())), d.cwiseAbs().maxCoeff()};
}

int Unknowns(const SurfaceFit& fit) { return fit.surface.size_u() * fit.surface.size_v(); }

PointCloud FrankeCloud(Eigen::Index count, double outliers = 0, std::uint64_t seed = 7) {
  return PointCloud::FromWorld(Scatter(Franke, count, kSigma, outliers, seed));
}

// Where residuals are those of too few control points, the loss must not take good points for
// outliers.
TEST(FitSurfaceTest, OutliersCostExactPointsLittle) {
  constexpr int kSeeds = 8;
  double logs = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> fast(-9, 9), turn(0, 2 * std::numbers::pi);
    std::vector<Eigen::Vector3d> waves(6);
    for (Eigen::Vector3d& wave : waves) wave << fast(engine), fast(engine), turn(engine);
    const auto height = [&](double x, double y) {
      double z = 0;
      for (const Eigen::Vector3d& w : waves) z += 0.03 * std::sin(w[0] * x + w[1] * y + w[2]);
      return z;
    };
    const Eigen::Matrix3Xd points = Scatter(height, 3000, 0, 0.1, seed);
    const SurfaceFit fit = FitSurface(PointCloud::FromWorld(points));
    Eigen::Index lost = 0;
    for (Eigen::Index k = 0; k < points.cols(); ++k)
      lost += fit.outliers[k] && points(2, k) == height(points(0, k), points(1, k));
    EXPECT_LE(lost, 60);  // a fiftieth
    logs += std::log(ErrorToTruth(fit.surface, TruthGrid(height, 60)).rms) / kSeeds;
  }
  EXPECT_LE(std::exp(logs), 2e-5);
}

// The published figures of the best open tools are 1.6e-4 with knots given and 3.2e-4 without.
TEST(FitSurfaceTest, ComesNearerToFrankesFunctionThanThePublishedFigures) {
  const SurfaceFit fit = FitSurface(FrankeCloud(20000));
  const TruthError error = ErrorToTruth(fit.surface, TruthGrid(Franke, 101));
  EXPECT_LE(error.rms, 1.3e-4);
  EXPECT_LE(error.max, 2.5e-3);
  EXPECT_LE(Unknowns(fit), 500);
  EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
  EXPECT_EQ(fit.report.input.used, 20000);
}

// A point or two of the noise's tail change sides while it is decided who counts; the grid is not
// searched anew for them.
TEST(FitSurfaceTest, ScoresNoGridTwiceForAHandfulOfPoints) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const SurfaceFit fit = FitSurface(FrankeCloud(60000, 0, seed));
    std::vector<std::pair<int, int>> scored;
    for (const RoundSummary& round : fit.report.iterations) {
      if (round.stage == "cross-validation")
        scored.emplace_back(round.control_points_u, round.control_points_v);
    }
    std::sort(scored.begin(), scored.end());
    EXPECT_EQ(std::adjacent_find(scored.begin(), scored.end()), scored.end());
    EXPECT_EQ(fit.report.input.used, 60000);
  }
}

TEST(FitSurfaceTest, SpendsAFewControlPointsOnANoisyPlane) {
  double squares = 0;  // of the error against what noise alone leaves
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const SurfaceFit fit =
        FitSurface(PointCloud::FromWorld(Scatter(Tilted, 20000, kSigma, 0, seed)));
    EXPECT_GE(Unknowns(fit), 16);
    EXPECT_LE(Unknowns(fit), 36);
    squares += std::pow(ErrorToTruth(fit.surface, TruthGrid(Tilted, 41)).rms / kSigma, 2) * 20000 /
               Unknowns(fit);
  }
  // One cloud exceeds 1.5 times the expected error now and then (the long test counts how often);
  // the mean of five does not.
  EXPECT_LE(std::sqrt(squares / 5), 1.5);
}

TEST(FitSurfaceTest, FollowsExactPointsBelowWhatLooksLikeNoise) {
  SurfaceFitOptions options;
  options.tolerance = 2e-3;
  const SurfaceFit fit = FitSurface(PointCloud::FromWorld(Scatter(Franke, 3000, 0, 0, 1)), options);
  EXPECT_EQ(fit.report.tolerance_reached(), true);
}

TEST(FitSurfaceTest, ReportsWhatAnIndependentMeasurementFinds) {
  const PointCloud cloud = FrankeCloud(3000, 0.01);
  SurfaceFitOptions options;
  options.tolerance = 3e-3;
  const SurfaceFit fit = FitSurface(cloud, options);
  ThreadPool pool(1);
  const SurfaceFootPoints finder(fit.surface);
  double squares = 0, max = 0;
  Eigen::Index out = 0, used = 0;
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const double d = finder.Nearest(cloud.World(k)).distance;
    EXPECT_NEAR(d, std::abs(fit.residuals[k]), 1e-12);
    EXPECT_NEAR(
        (fit.surface.At(fit.parameters(0, k), fit.parameters(1, k)) - cloud.World(k)).norm(),
        d,
        1e-12);
    if (fit.outliers[k]) continue;
    ++used;
    squares += d * d;
    max = std::max(max, d);
    if (d > 3e-3) ++out;
  }
  EXPECT_EQ(fit.report.error.points, used);
  EXPECT_EQ(fit.report.error.out_of_tolerance, out);
  EXPECT_NEAR(fit.report.error.rms, std::sqrt(squares / static_cast<double>(used)), 1e-12);
  EXPECT_NEAR(fit.report.error.max, max, 1e-12);
  EXPECT_EQ(fit.report.tolerance_reached(), out == 0);
  EXPECT_EQ(fit.report.input.outliers, cloud.size() - used);
}

TEST(FitSurfaceTest, FollowsACloudThatIsMovedTurnedAndScaled) {
  const Eigen::Matrix3Xd points = Scatter(Franke, 4000, kSigma, 0, 3);
  const SurfaceFit plain = FitSurface(PointCloud::FromWorld(points));
  const TruthError near = ErrorToTruth(plain.surface, TruthGrid(Franke, 61));
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(0.9, Eigen::Vector3d(1, -2, 0.7).normalized()));
  for (const double scale : {1e-6, 1.0, 1e6}) {
    SCOPED_TRACE("scale " + std::to_string(scale));
    const Eigen::Vector3d shift = scale * Eigen::Vector3d(3, -2, 5);
    const SurfaceFit fit =
        FitSurface(PointCloud::FromWorld((scale * turn * points).colwise() + shift));
    const TruthError far =
        ErrorToTruth(fit.surface, (scale * turn * TruthGrid(Franke, 61)).colwise() + shift);
    // Another base direction is as good, not the same: the noise enters the heights otherwise.
    EXPECT_LE(far.rms, 1.5 * scale * near.rms);
    EXPECT_NEAR(fit.report.input.noise,
                scale * plain.report.input.noise,
                0.02 * scale * plain.report.input.noise);
  }
}

TEST(FitSurfaceTest, FitsAsWellFarFromTheOriginAsNearIt) {
  const Eigen::Vector3d utm(500000, 5400000, 300);
  Eigen::Matrix3Xd points = Scatter(Franke, 5000, 1e-4, 0, 11);
  points.row(2) *= 1e-3;  // structure of a millimetre with noise of 0.1 µm on a metre
  const SurfaceFit near = FitSurface(PointCloud::FromWorld(points));
  const SurfaceFit far = FitSurface(PointCloud::FromWorld(points.colwise() + utm));
  EXPECT_EQ(far.surface.size_u(), near.surface.size_u());
  EXPECT_EQ(far.surface.size_v(), near.surface.size_v());
  // Coordinates of 5.4e6 are known to 1e-9.
  EXPECT_NEAR(far.report.error.rms, near.report.error.rms, 2e-9);
  SurfaceFitOptions local;
  local.shift = utm;
  EXPECT_LE(FitSurface(PointCloud::FromWorld(points.colwise() + utm), local)
                .surface.control_points()
                .cwiseAbs()
                .maxCoeff(),
            2.0);
}

TEST(FitSurfaceTest, SetsGrossOutliersAsideAndStaysNearTheCleanFit) {
  const Eigen::Matrix3Xd truth = TruthGrid(Franke, 81);
  const double clean = ErrorToTruth(FitSurface(FrankeCloud(20000)).surface, truth).rms;
  for (const double share : {0.01, 0.05}) {
    SCOPED_TRACE("share " + std::to_string(share));
    const SurfaceFit fit = FitSurface(FrankeCloud(20000, share));
    EXPECT_LE(ErrorToTruth(fit.surface, truth).rms, 1.3 * clean);
    EXPECT_NEAR(
        static_cast<double>(fit.report.input.outliers), share * 20000, 0.15 * share * 20000);
  }
}

TEST(FitSurfaceTest, RefinesUntilTheToleranceHoldsAndNoFurther) {
  SurfaceFitOptions options;
  options.tolerance = 6e-3;
  const SurfaceFit fine = FitSurface(FrankeCloud(20000), options);
  EXPECT_EQ(fine.report.tolerance_reached(), true);
  EXPECT_LE(fine.report.error.max, 6e-3);
  options.tolerance = 0.1;
  const SurfaceFit coarse = FitSurface(FrankeCloud(20000), options);
  EXPECT_EQ(coarse.report.tolerance_reached(), true);
  EXPECT_LT(Unknowns(coarse), Unknowns(fine));
}

// A fifth of the points stands above the sheet, most of them by little: their distances thin out as
// those of structure do, but none has company.
// A coarse net that a tolerance asks for is fitted with free parameters, which would let its edges
// wander in and out of the points, and fold beside them.
TEST(FitSurfaceTest, EndsWhereThePointsEndAndDoesNotFoldWithinATolerance) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    SurfaceFitOptions options;
    options.tolerance = 6 * kSigma;
    const SurfaceFit fit = FitSurface(FrankeCloud(20000, 0, seed), options);
    EXPECT_EQ(fit.report.termination, Termination::kToleranceReached);
    EXPECT_TRUE(fit.report.optimize.ran);
    EXPECT_EQ(fit.surface.trims().size(), 0);
    EXPECT_EQ(FoldedPairs(fit.surface), 0);
    const double spacing = fit.report.input.spacing;
    for (int k = 0; k <= 200; ++k) {
      const double at = k / 200.0;
      for (const auto& [u, v] : {std::pair(at, 0.0), {at, 1.0}, {0.0, at}, {1.0, at}}) {
        const SplineBasis &in_u = fit.surface.basis_u(), &in_v = fit.surface.basis_v();
        const Eigen::Vector3d edge =
            fit.surface.At(in_u.lower() + u * (in_u.upper() - in_u.lower()),
                           in_v.lower() + v * (in_v.upper() - in_v.lower()));
        const double depth = std::min({edge.x(), edge.y(), 1 - edge.x(), 1 - edge.y()});
        EXPECT_LE(std::abs(depth), 2 * spacing) << u << " " << v;
      }
    }
  }
}

TEST(FitSurfaceTest, IsNotPulledByOutliersToOneSide) {
  const Eigen::Matrix3Xd truth = TruthGrid(Franke, 101),
                         clean = Scatter(Franke, 20000, kSigma, 0, 5);
  Eigen::Matrix3Xd raised = clean;
  std::mt19937_64 engine(5);
  std::normal_distribution<double> off(0, 20 * kSigma);
  for (Eigen::Index k = 0; k < raised.cols(); k += 5) raised(2, k) += std::abs(off(engine));
  const double alone = ErrorToTruth(FitSurface(PointCloud::FromWorld(clean)).surface, truth).rms;
  EXPECT_LT(ErrorToTruth(FitSurface(PointCloud::FromWorld(raised)).surface, truth).rms, 2 * alone);
}

// Where a hole takes knots of its own to stay calm, the surface has them.
TEST(FitSurfaceTest, RisesNoHigherThanAMissingPeakDoes) {
  const auto inside = [](double x, double y) { return std::hypot(x - 0.22, y - 0.22) < 0.15; };
  const Eigen::Matrix3Xd all = Scatter(Franke, 20000, kSigma, 0, 6);
  std::vector<Eigen::Index> kept;
  double low = 2, high = -1;
  for (Eigen::Index k = 0; k < all.cols(); ++k) {
    if (inside(all(0, k), all(1, k))) continue;
    kept.push_back(k);
    if (std::hypot(all(0, k) - 0.22, all(1, k) - 0.22) > 0.16) continue;
    low = std::min(low, all(2, k));
    high = std::max(high, all(2, k));
  }
  const SurfaceFit fit = FitSurface(PointCloud::FromWorld(all(Eigen::all, kept)));
  const NurbsSurface& surface = fit.surface;
  // Held down to the rim, the surface would leave its points: by a tenth more than the noise.
  EXPECT_LE(fit.report.error.rms, 1.02 * kSigma);
  const double slack = fit.report.input.spacing + 3 * kSigma;  // of bounds
  for (int i = 0; i <= 200; ++i) {
    for (int j = 0; j <= 200; ++j) {
      const Eigen::Vector3d at =
          surface.At(surface.basis_u().lower() +
                         (surface.basis_u().upper() - surface.basis_u().lower()) * i / 200,
                     surface.basis_v().lower() +
                         (surface.basis_v().upper() - surface.basis_v().lower()) * j / 200);
      if (!inside(at[0], at[1])) continue;
      ASSERT_GT(at[2], low - 0.1 * (high - low) - slack);
      const double peak = std::max(high, Franke(at[0], at[1]));
      ASSERT_LT(at[2], peak + 0.1 * (high - low) + slack);
    }
  }
}

// Equal cells as fine as the wavy half asks for keep the tolerance too; they are not kept.
TEST(FitSurfaceTest, KeepsNoKnotLinesThatAToleranceDoesNotTake) {
  const auto half_wavy = [](double x, double y) {
    return x < 0.5 ? 0.0 : 0.05 * std::pow(std::sin(30 * (x - 0.5)), 3) * std::cos(3 * y);
  };
  SurfaceFitOptions options;
  options.tolerance = 6e-3;
  const SurfaceFit fit =
      FitSurface(PointCloud::FromWorld(Scatter(half_wavy, 10000, kSigma, 0, 3)), options);
  EXPECT_EQ(fit.report.tolerance_reached(), true);
  const SplineBasis& across = fit.surface.basis_u();
  const double middle = (across.lower() + across.upper()) / 2;
  int flat = 0, wavy = 0;
  for (const int span : across.Spans()) {
    (across.knots()[static_cast<size_t>(span) + 1] <= middle ? flat : wavy) += 1;
  }
  EXPECT_LT(2 * flat, wavy);
  const auto rounds = fit.report.iterations;
  EXPECT_TRUE(std::any_of(rounds.begin(), rounds.end(), [](const auto& round) {
    return round.stage == "fewer lines";
  }));
}

// Many more control points than the data carry: fairness from the data keeps them from the noise.
TEST(FitSurfaceTest, ChoosesFairnessByTheData) {
  const PointCloud cloud = FrankeCloud(4000);
  SurfaceFitOptions options;
  options.control_points = {30, 30};
  options.optimize = FreeVariables{};
  options.smoothing = 1e-9;
  const Eigen::Matrix3Xd truth = TruthGrid(Franke, 101);
  const double free = ErrorToTruth(FitSurface(cloud, options).surface, truth).rms;
  options.smoothing.reset();
  for (const SmoothBy by : {SmoothBy::kCrossValidation, SmoothBy::kNoise}) {
    options.smooth_by = by;
    const SurfaceFit fit = FitSurface(cloud, options);
    EXPECT_EQ(Unknowns(fit), 900);
    EXPECT_LT(ErrorToTruth(fit.surface, truth).rms, 0.75 * free);
  }
  for (const auto& spoil : {+[](SurfaceFitOptions& o) { o.tolerance = 0.1; },
                            +[](SurfaceFitOptions& o) { o.smoothing = 1e-3; },
                            +[](SurfaceFitOptions& o) { o.loss = Loss::kHuber; }}) {
    SurfaceFitOptions spoilt = options;
    spoil(spoilt);
    EXPECT_THROW(Check(spoilt), std::invalid_argument);
  }
}

TEST(FitSurfaceTest, SaysSoWhenTheToleranceIsBelowTheNoise) {
  SurfaceFitOptions options;
  options.tolerance = kSigma / 5;
  const SurfaceFit fit = FitSurface(FrankeCloud(4000), options);
  EXPECT_EQ(fit.report.tolerance_reached(), false);
  EXPECT_NE(fit.report.termination, Termination::kToleranceReached);
  EXPECT_LE(Unknowns(fit), 4000 / 2);
  EXPECT_GT(fit.report.error.out_of_tolerance, 0);
}

TEST(FitSurfaceTest, DoesNotFollowAToleranceIntoTheNoise) {
  // Four sigma: noise alone leaves one point in sixteen thousand outside.
  SurfaceFitOptions options;
  options.tolerance = 4 * kSigma;
  const SurfaceFit fit = FitSurface(FrankeCloud(20000), options);
  EXPECT_LE(Unknowns(fit), 800);
}

TEST(FitSurfaceTest, StaysCalmWhereThereAreNoPoints) {
  // Three quarters of the square, and a hole.
  const Eigen::Matrix3Xd all = Scatter(Franke, 4000, kSigma, 0, 5);
  PointMask keep(all.cols());
  for (Eigen::Index k = 0; k < all.cols(); ++k) {
    const double x = all(0, k), y = all(1, k);
    keep[k] = !(x > 0.5 && y > 0.5) && std::hypot(x - 0.3, y - 0.3) > 0.15;
  }
  const SurfaceFit fit = FitSurface(PointCloud::FromWorld(all).Subset(keep));
  const SplineBasis &bu = fit.surface.basis_u(), &bv = fit.surface.basis_v();
  const double slack = fit.report.input.spacing + 3 * kSigma;  // of bounds
  for (int i = 0; i <= 200; ++i) {
    for (int j = 0; j <= 200; ++j) {
      const double z = fit.surface.At(bu.upper() * i / 200, bv.upper() * j / 200)[2];
      ASSERT_GE(z, -0.05 - slack);  // the range is 0 to 1.22
      ASSERT_LE(z, 1.27 + slack);
    }
  }
  EXPECT_EQ(fit.surface.trims().size(), 2u) << "the outer edge, and the hole that it is calm in";
}

TEST(FitSurfaceTest, GivesTheSameBitsForTheSameThreadsAndNearlyForOthers) {
  SurfaceFitOptions options;
  options.threads = 2;
  const PointCloud cloud = FrankeCloud(6000, 0.01);
  const SurfaceFit first = FitSurface(cloud, options), second = FitSurface(cloud, options);
  EXPECT_EQ(first.surface, second.surface);
  options.threads = 1;
  const SurfaceFit alone = FitSurface(cloud, options);
  ASSERT_EQ(alone.surface.control_points().cols(), first.surface.control_points().cols());
  EXPECT_LE((alone.surface.control_points() - first.surface.control_points()).cwiseAbs().maxCoeff(),
            1e-9);
}

TEST(FitSurfaceTest, CountsDuplicatesAndGivesEveryPointItsFoot) {
  const Eigen::Matrix3Xd once = Scatter(Franke, 2000, kSigma, 0, 5);
  Eigen::Matrix3Xd twice(3, 2500);
  twice << once, once.leftCols(500);
  const SurfaceFit fit = FitSurface(PointCloud::FromWorld(twice));
  EXPECT_EQ(fit.report.input.duplicates, 500);
  EXPECT_EQ(fit.residuals.size(), 2500);
  EXPECT_EQ(fit.residuals.head(500), fit.residuals.tail(500));
}

TEST(FitSurfaceTest, ReproducesExactPlanesHoweverFewThePoints) {
  for (const int side : {2, 3, 4, 6, 10, 20}) {
    SCOPED_TRACE(side);
    Eigen::Matrix3Xd grid = TruthGrid(Tilted, side);
    const SurfaceFit fit = FitSurface(PointCloud::FromWorld(grid));
    EXPECT_LE(fit.report.error_all.max, 1e-12);
    EXPECT_EQ(fit.report.input.outliers, 0);
    EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
  }
}

TEST(FitSurfaceTest, KeepsExactStepsAndRibs) {
  Eigen::Matrix3Xd step = TruthGrid([](double x, double) { return x > 0.5 ? 1.0 : 0.0; }, 30);
  EXPECT_EQ(FitSurface(PointCloud::FromWorld(step)).report.input.outliers, 0);
  Eigen::Matrix3Xd rib =
      TruthGrid([](double x, double) { return std::abs(x - 0.5) < 0.016 ? 0.05 : 0.0; }, 100);
  EXPECT_EQ(FitSurface(PointCloud::FromWorld(rib)).report.input.outliers, 0);
}

// Exact flanks make the tip look foreign; it is as good as they are. Half a knot cell times the
// slope is what a smooth surface rounds the tip by; one that lets go of the tip misses it by more.
TEST(FitSurfaceTest, KeepsTheTipOfAnExactCone) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    for (const double slope : {1.0, 2.0}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", slope " + std::to_string(slope));
      Eigen::Matrix3Xd disc = Scatter([](double, double) { return 0.0; }, 5000, 0, 0, seed);
      for (auto point : disc.colwise()) {
        const double radius = std::sqrt(point.x()), angle = 2 * std::numbers::pi * point.y();
        point << radius * std::cos(angle), radius * std::sin(angle), slope * radius;
      }
      SurfaceFitOptions options;
      options.optimize = FreeVariables{};
      const SurfaceFit fit = FitSurface(PointCloud::FromWorld(disc), options);
      EXPECT_EQ(fit.report.input.outliers, 0);
      const double cell = 2.0 / (std::min(fit.surface.size_u(), fit.surface.size_v()) - 3);
      EXPECT_LE(fit.report.error_all.max, 0.5 * slope * cell);
    }
  }
}

TEST(FitSurfaceTest, TakesEveryDegreeAndAnyNetItIsTold) {
  const PointCloud cloud = FrankeCloud(3000);
  for (const auto& [p, q] : {std::pair{1, 1}, {2, 5}, {5, 2}, {7, 3}}) {
    SCOPED_TRACE(std::to_string(p) + "," + std::to_string(q));
    SurfaceFitOptions options;
    options.degree_u = p;
    options.degree_v = q;
    const SurfaceFit fit = FitSurface(cloud, options);
    EXPECT_EQ(fit.surface.basis_u().degree(), p);
    EXPECT_EQ(fit.surface.basis_v().degree(), q);
    EXPECT_LE(fit.report.error.rms, 20 * kSigma);
    options.control_points = {{p + 4, q + 9}};
    const SurfaceFit told = FitSurface(cloud, options);
    EXPECT_EQ(told.surface.size_u(), p + 4);
    EXPECT_EQ(told.surface.size_v(), q + 9);
  }
}

TEST(FitSurfaceTest, RefusesPointsThatCarryNoSurfaceWithTheReason) {
  const auto reason = [](const Eigen::Matrix3Xd& points) -> std::string {
    try {
      FitSurface(PointCloud::FromWorld(points));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(reason(Eigen::Matrix3Xd(3, 0)).find("no points"), std::string::npos);
  EXPECT_NE(reason(Eigen::Matrix3Xd::Random(3, 3)).find("4 different points"), std::string::npos);
  EXPECT_NE(reason(Eigen::Vector3d(1, 2, 3).replicate(1, 50)).find("4 different points"),
            std::string::npos);
  Eigen::Matrix3Xd line(3, 100);
  for (int k = 0; k < 100; ++k) line.col(k) = k * Eigen::Vector3d(1, 2, -0.5);
  EXPECT_NE(reason(line).find("line"), std::string::npos);
  Eigen::Matrix3Xd corners(3, 12);  // of two cubes side by side: no base has a place for any
  for (int k = 0; k < 12; ++k) corners.col(k) << 10 * (k / 4), 10 * (k / 2 % 2), 10 * (k % 2);
  EXPECT_NE(reason(corners).find("do not determine the control points"), std::string::npos);
  Eigen::Matrix3Xd band(3, 4000);
  for (Eigen::Index k = 0; k < band.cols(); ++k) {
    const Eigen::Vector2d place = Eigen::Vector2d::Random();
    const double angle = std::numbers::pi * place[0], across = 0.3 * place[1];
    const double radius = 1 + across * std::cos(angle / 2);
    band.col(k) << radius * std::cos(angle), radius * std::sin(angle), across * std::sin(angle / 2);
  }
  EXPECT_NE(reason(band).find("open sheet"), std::string::npos);
}

TEST(FitSurfaceTest, NamesTheOptionThatBreaksItsRule) {
  const auto reason = [](const SurfaceFitOptions& options) -> std::string {
    try {
      Check(options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(reason({.degree_u = 0}).find("degree_u"), std::string::npos);
  EXPECT_NE(reason({.degree_v = 26}).find("degree_v"), std::string::npos);
  EXPECT_NE(reason({.tolerance = 0.0}).find("tolerance"), std::string::npos);
  EXPECT_NE(reason({.control_points = std::pair{3, 9}}).find("control_points"), std::string::npos);
  EXPECT_NE(reason({.smoothing = -1.0}).find("smoothing"), std::string::npos);
  EXPECT_NE(reason({.loss_scale = NAN}).find("loss_scale"), std::string::npos);
  EXPECT_EQ(reason({}), "");
}

TEST(FitSurfaceTest, StopsWhenProgressSaysSo) {
  SurfaceFitOptions options;
  options.progress = [](const char*, double) { return false; };
  EXPECT_THROW(FitSurface(FrankeCloud(2000), options), Cancelled);
  // Exact points, so that there is something to refine.
  const PointCloud exact = PointCloud::FromWorld(Scatter(Franke, 2000, 0, 0, 1));
  options.tolerance = 1e-6;
  options.progress = [](const char* stage, double) { return std::string(stage) != "refine"; };
  EXPECT_EQ(FitSurface(exact, options).report.termination, Termination::kCancelled);
}

TEST(FitSurfaceTest, RunsTheJointStageWhereControlPointsAreFewAndOnlyThere) {
  const PointCloud cloud = FrankeCloud(20000);
  EXPECT_FALSE(FitSurface(cloud).report.optimize.ran);
  SurfaceFitOptions options;
  options.control_points = {{12, 12}};
  options.optimize = FreeVariables{};
  const Eigen::Matrix3Xd truth = TruthGrid(Franke, 101);
  const TruthError linear = ErrorToTruth(FitSurface(cloud, options).surface, truth);
  options.optimize = std::nullopt;
  const SurfaceFit joint = FitSurface(cloud, options);
  EXPECT_TRUE(joint.report.optimize.ran);
  EXPECT_LT(joint.report.optimize.rms_after, joint.report.optimize.rms_before);
  EXPECT_LE(ErrorToTruth(joint.surface, truth).rms, 0.6 * linear.rms);
}

TEST(LongFitSurfaceTest, HoldsItsFiguresOverManySeeds) {
  const Eigen::Matrix3Xd truth = TruthGrid(Franke, 101);
  int far_corners = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const SurfaceFit fit = FitSurface(FrankeCloud(20000, 0, seed));
    const TruthError error = ErrorToTruth(fit.surface, truth);
    EXPECT_LE(error.rms, 1.3e-4);
    EXPECT_LE(Unknowns(fit), 500);
    if (error.max > 2.5e-3) ++far_corners;
    const SurfaceFit many = FitSurface(FrankeCloud(100000, 0, seed));
    EXPECT_LE(ErrorToTruth(many.surface, truth).rms, 6.5e-5);
    EXPECT_LE(Unknowns(many), 700);
  }
  // The largest error sits in a corner, where a single point with a lucky deviation decides: one
  // cloud in twenty (seed 2, 2.63e-3) goes beyond what the published clouds ask for.
  EXPECT_LE(far_corners, 1);
}

TEST(LongFitSurfaceTest, SpendsAFewControlPointsOnManyNoisyPlanes) {
  int wasteful = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const SurfaceFit fit =
        FitSurface(PointCloud::FromWorld(Scatter(Tilted, 20000, kSigma, 0, seed)));
    const double error = ErrorToTruth(fit.surface, TruthGrid(Tilted, 41)).rms;
    if (Unknowns(fit) > 36 || error > 1.5 * kSigma * std::sqrt(Unknowns(fit) / 20000.0)) ++wasteful;
  }
  // Sixteen coefficients alone exceed one and a half times their expected error in 3 of 1000
  // clouds.
  EXPECT_LE(wasteful, 3);
}

TEST(LongFitSurfaceTest, LeavesTwentyPercentOfOutliersAlone) {
  const Eigen::Matrix3Xd truth = TruthGrid(Franke, 101);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const SurfaceFit fit = FitSurface(FrankeCloud(20000, 0.2, seed));
    EXPECT_LE(ErrorToTruth(fit.surface, truth).rms, 1.5 * 1.3e-4);
  }
}

}  // namespace batten::internal::fit_surface_test
