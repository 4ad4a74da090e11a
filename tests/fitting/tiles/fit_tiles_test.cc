// SPDX-License-Identifier: MIT
// Laws of tiles: parts of one surface, which is the least-squares one; freedom where the data ask.
#include "batten/fitting/fit_tiles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "batten/fitting/distances.h"
#include "batten/fitting/solve_linear.h"
#include "known_clouds.h"
#include "tolerances.h"

namespace batten::internal::fit_tiles_test {

using ::testing::HasSubstr;

constexpr double kSigma = 0.002;

double Waves(double x, double y) { return 0.05 * std::sin(9 * x) + 0.04 * std::cos(8 * y); }

// Waves, and in the corner (0.75 … 1)² ripples of a tenth of their length.
double Rippled(double x, double y) {
  const double into = std::max(0.0, std::min(x, y) - 0.75);
  return Waves(x, y) + 0.3 * into * into * std::sin(90 * x) * std::sin(90 * y);
}

SurfaceFitOptions Untrimmed() {
  SurfaceFitOptions options;
  options.trim = Trimming::kNone;
  options.threads = 1;
  return options;
}

double TruthError(const NurbsSurface& surface, const Eigen::Matrix3Xd& truth) {
  ThreadPool pool(1);
  const Eigen::VectorXd d = DistancesTo(surface, truth, pool).distances;
  return std::sqrt(d.squaredNorm() / static_cast<double>(d.size()));
}

TiledFit Fit(const Eigen::Matrix3Xd& points, const SurfaceFitOptions& options, TileOptions tiles) {
  ArraySource source(points);
  tiles.sample = 10000;
  return FitTiles(source, options, tiles);
}

TEST(FitTilesTest, FacesJoinAsPartsOfOneSurface) {
  const Eigen::Matrix3Xd points = Scatter(Rippled, 60000, kSigma, 0, 1);
  const TiledFit fit = Fit(points, Untrimmed(), {.count_u = 3, .count_v = 2});
  const std::vector<NurbsSurface> faces = TileFaces(fit);
  ASSERT_EQ(faces.size(), 6);
  const NurbsSurface& whole = fit.whole.surface;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 2; ++j) {
      const NurbsSurface& face = faces[2 * i + j];
      EXPECT_EQ(face.basis_u().lower(), fit.breaks_u[i]);
      EXPECT_EQ(face.basis_v().upper(), fit.breaks_v[j + 1]);
      const TileSummary& tile = fit.whole.report.tiles[2 * i + j];
      EXPECT_EQ(face.size_u(), tile.control_points_u);
      EXPECT_EQ(face.size_v(), tile.control_points_v);
      if (i == 2) continue;
      // The edge bit by bit; across it first and second derivatives, to rounding of these.
      const NurbsSurface& next = faces[2 * (i + 1) + j];
      ASSERT_EQ(face.size_v(), next.size_v());
      EXPECT_EQ(face.control_points().rightCols(face.size_v()),
                next.control_points().leftCols(next.size_v()));
      const double u = fit.breaks_u[i + 1], cell = whole.basis_u().upper() / whole.size_u();
      for (int k = 0; k <= 10; ++k) {
        const double v = std::lerp(face.basis_v().lower(), face.basis_v().upper(), k / 10.0);
        const SurfaceJet a = face.JetAt(u, v), b = next.JetAt(u, v);
        EXPECT_LT((a.du - b.du).norm(), kRounding / cell);
        EXPECT_LT((a.duu - b.duu).norm(), kRounding / (cell * cell));
        EXPECT_LT((a.duv - b.duv).norm(), kRounding / (cell * cell));
      }
    }
  }
}

// The oracle: the problem of all points over the same bases, in memory, factored as one band.
TEST(FitTilesTest, IsTheLeastSquaresSurface) {
  const Eigen::Matrix3Xd points = Scatter(Waves, 40000, kSigma, 0, 2);
  SurfaceFitOptions options = Untrimmed();
  options.control_points = {60, 50};
  const TiledFit fit = Fit(points, options, {.count_u = 2, .count_v = 2});
  const NurbsSurface& surface = fit.whole.surface;
  ASSERT_EQ(surface.size_u(), 60);
  ASSERT_EQ(surface.size_v(), 50);
  ASSERT_EQ(fit.whole.report.input.outliers, 0);
  const Eigen::Matrix3d axes = fit.whole.report.geometry.base_axes.value();
  const Eigen::Vector3d corner = axes.transpose() * surface.At(0, 0);
  const Eigen::Matrix3Xd framed = axes.transpose() * points;
  auto data = std::make_shared<FittingData>();
  data->parameters = framed.topRows<2>().colwise() - corner.head<2>();
  data->values = framed.row(2);
  ThreadPool pool(1);
  const LinearSolution expected =
      SolveLinear(FittingProblem(surface.basis_u(), surface.basis_v(), data, 1e-4), pool);
  const Eigen::RowVectorXd heights = axes.col(2).transpose() * surface.control_points();
  EXPECT_LT((heights - expected.coefficients).cwiseAbs().maxCoeff(),
            kIterated * heights.cwiseAbs().maxCoeff());
}

TEST(FitTilesTest, FreedomGoesWhereTheDataAskForIt) {
  const Eigen::Matrix3Xd points = Scatter(Rippled, 120000, kSigma, 0, 3);
  const TiledFit fit = Fit(points, Untrimmed(), {.count_u = 4, .count_v = 4});
  const std::vector<TileSummary>& tiles = fit.whole.report.tiles;
  ASSERT_EQ(tiles.size(), 16);
  // The corner is fine, and with it its column and its row; the rest is coarse.
  const auto of = [&](int i, int j) { return tiles[4 * i + j]; };
  EXPECT_GE(of(3, 3).control_points_u, 2 * of(0, 0).control_points_u - 3);
  EXPECT_EQ(of(3, 0).control_points_u, of(3, 3).control_points_u);
  EXPECT_EQ(of(3, 0).control_points_v, of(0, 0).control_points_v);
  Eigen::Index counted = 0;
  for (const TileSummary& tile : tiles) {
    counted += tile.points + tile.outliers;
    // At the noise everywhere; on slopes of up to a half its share along the normal.
    EXPECT_LT(tile.rms, 1.03 * kSigma);
    EXPECT_GT(tile.rms, 0.8 * kSigma);
  }
  EXPECT_EQ(counted, points.cols());
  const Eigen::Matrix3Xd truth = TruthGrid(Rippled, 100);
  EXPECT_LT(TruthError(fit.whole.surface, truth), 0.5 * kSigma);
  EXPECT_EQ(fit.whole.report.termination, Termination::kNoiseReached);
}

TEST(FitTilesTest, AToleranceTakesFewerControlPoints) {
  const Eigen::Matrix3Xd points = Scatter(Rippled, 120000, kSigma, 0, 3);
  const TiledFit best = Fit(points, Untrimmed(), {.count_u = 4, .count_v = 4});
  SurfaceFitOptions options = Untrimmed();
  options.tolerance = 0.04;
  const TiledFit fit = Fit(points, options, {.count_u = 4, .count_v = 4});
  EXPECT_EQ(fit.whole.report.tolerance_reached(), true);
  EXPECT_LE(fit.whole.report.error.max, 0.04);
  EXPECT_LT(fit.whole.surface.control_points().cols(), best.whole.surface.control_points().cols());
}

// A bent sheet: parameters are feet on the sample's surface first, then on the surface itself.
TEST(FitTilesTest, BentSheetsAreFollowed) {
  const auto radius = [](double turn) { return 5 + 0.1 * std::sin(9 * turn); };
  const auto bend = [&](Eigen::Matrix3Xd points) {
    for (auto point : points.colwise()) {
      const double turn = 4.5 * point[0], r = radius(turn) + point[2];
      point = Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), 4 * point[1]);
    }
    return points;
  };
  const auto flat = [](double, double) { return 0.0; };
  const Eigen::Matrix3Xd points = bend(Scatter(flat, 100000, kSigma, 0, 4));
  const TiledFit fit = Fit(points, Untrimmed(), {.count_u = 3, .count_v = 2});
  EXPECT_EQ(fit.whole.report.geometry.base, "sheet");
  const double freedom = static_cast<double>(fit.whole.surface.control_points().cols());
  EXPECT_LT(TruthError(fit.whole.surface, bend(TruthGrid(flat, 60))),
            2 * kSigma * std::sqrt(freedom / static_cast<double>(points.cols())));
}

TEST(FitTilesTest, TilesWithoutPointsHaveNoFace) {
  Eigen::Matrix3Xd points = Scatter(Waves, 80000, kSigma, 0, 5);
  for (auto point : points.colwise()) {  // an L
    const double noise = point[2] - Waves(point[0], point[1]);
    if (point[0] > 0.48 && point[1] > 0.48)
      point.head<2>() = 0.9 * (point.head<2>() - Eigen::Vector2d(0.48, 0.48));
    point[2] = Waves(point[0], point[1]) + noise;
  }
  const TiledFit fit = Fit(points, Untrimmed(), {.count_u = 4, .count_v = 4});
  EXPECT_EQ(TileFaces(fit).size(), 12);
  SurfaceFitOptions trimmed = Untrimmed();
  trimmed.trim = Trimming::kAuto;
  const TiledFit cut = Fit(points, trimmed, {.count_u = 4, .count_v = 4});
  EXPECT_TRUE(cut.whole.surface.trimmed());
  EXPECT_GE(TileFaces(cut).size(), 12);
}

TEST(FitTilesTest, WhatCannotBeIsRefused) {
  const Eigen::Matrix3Xd points = Scatter(Waves, 20000, kSigma, 0, 6);
  const auto reason = [&](const SurfaceFitOptions& options, const TileOptions& tiles) {
    try {
      ArraySource source(points);
      FitTiles(source, options, tiles);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  SurfaceFitOptions thinned;
  thinned.thin = 0.1;
  EXPECT_THAT(reason(thinned, {}), HasSubstr("thin: needs all points in memory"));
  EXPECT_THAT(reason({}, {.count_u = 2}), HasSubstr("count_u, count_v: 2, 0"));
  EXPECT_THAT(reason({}, {.count_u = 900, .count_v = 1}),
              HasSubstr("900 x 1 tiles are more than the "));
  SurfaceFitOptions many;
  many.control_points = {600, 500};
  EXPECT_THAT(reason(many, {.count_u = 2, .count_v = 2}),
              HasSubstr("600 x 500 are far more than 20000 points determine"));
  SurfaceFitOptions stopped = Untrimmed();
  stopped.progress = [](const char* stage, double) { return std::string(stage) != "project"; };
  ArraySource source(points);
  EXPECT_THROW(FitTiles(source, stopped, {}), Cancelled);
}

}  // namespace batten::internal::fit_tiles_test
