// SPDX-License-Identifier: MIT
// Laws of fits of many points: what a sample and sums give is what all points give.
#include <gtest/gtest.h>

#include <cmath>

#include "batten/fitting/distances.h"
#include "batten/fitting/fit_surface.h"
#include "batten/fitting/uncertainty.h"
#include "fitting/streaming/fit_by_sums.h"
#include "fitting/surface/fit_in_memory.h"
#include "known_clouds.h"
#include "tolerances.h"

namespace batten::internal::fit_by_sums_test {

constexpr Eigen::Index kMany = 60000, kSample = 15000;
constexpr double kSigma = 0.005;

double Wavy(double x, double y) {
  return 0.08 * std::sin(7 * x) + 0.05 * std::cos(6 * y) + 0.02 * std::sin(14 * x + 8 * y);
}

SurfaceFit InMemory(const PointCloud& cloud, const SurfaceFitOptions& options) {
  StageClock clock;
  return FitInMemory(cloud, options, clock);
}

std::optional<SurfaceFit> BySums(const PointCloud& cloud, const SurfaceFitOptions& options) {
  StageClock clock;
  return FitBySums(cloud, options, kSample, clock);
}

double TruthError(const NurbsSurface& surface) {
  ThreadPool pool(2);
  const Eigen::VectorXd d = DistancesTo(surface, TruthGrid(Wavy, 100), pool).distances;
  return std::sqrt(d.squaredNorm() / static_cast<double>(d.size()));
}

TEST(FitBySumsTest, IsTheFitOfAllPoints) {
  const PointCloud cloud(Scatter(Wavy, kMany, kSigma, 0, 1));
  const SurfaceFitOptions options;
  const std::optional<SurfaceFit> found = BySums(cloud, options);
  ASSERT_TRUE(found);
  const SurfaceFit &sums = *found, all = InMemory(cloud, options);
  EXPECT_EQ(sums.surface.size_u(), all.surface.size_u());
  EXPECT_EQ(sums.surface.size_v(), all.surface.size_v());
  constexpr double kAsGood = 1.02;
  EXPECT_LT(TruthError(sums.surface), kAsGood * TruthError(all.surface));
  EXPECT_EQ(sums.report.termination, all.report.termination);
  EXPECT_EQ(sums.report.input.points, kMany);
  EXPECT_EQ(sums.report.error.points, kMany);
  // Foot points and distances are those of the surface.
  ThreadPool pool(2);
  const PointDistances feet = DistancesTo(sums.surface, cloud.points(), pool);
  EXPECT_LT((feet.distances - sums.residuals).cwiseAbs().maxCoeff(), kIterated);
  EXPECT_NEAR(sums.report.error.p95, all.report.error.p95, 0.01 * kSigma);
  // Error bars are those of all points.
  const Uncertainty a(sums, cloud), b(all, cloud);
  constexpr double kAlike = 0.05;
  for (const auto& [u, v] : {std::pair(0.5, 0.5), std::pair(0.2, 0.7)})
    EXPECT_NEAR(a.At(u, v).deviation, b.At(u, v).deviation, kAlike * b.At(u, v).deviation);
}

TEST(FitBySumsTest, GivesWayWhereSumsLoseSomething) {
  const auto gives_way = [](const PointCloud& cloud, const SurfaceFitOptions& options) {
    return !BySums(cloud, options);
  };
  EXPECT_TRUE(gives_way(PointCloud(Scatter(Wavy, kMany, kSigma, 0.01, 2)), {})) << "outliers";
  Eigen::Matrix3Xd few = Scatter(Wavy, kMany, kSigma, 0, 3);
  for (Eigen::Index k = 0; k < 5; ++k) few(2, 1000 * k) += 1;
  EXPECT_TRUE(gives_way(PointCloud(few), {})) << "five outliers, which a sample may miss";
  Eigen::Matrix3Xd disc = Scatter(Wavy, 2 * kMany, kSigma, 0, 4);
  Eigen::Index kept = 0;
  for (Eigen::Index k = 0; k < disc.cols(); ++k)
    if ((disc.col(k).head<2>() - Eigen::Vector2d(0.5, 0.5)).norm() < 0.48)
      disc.col(kept++) = disc.col(k);
  ASSERT_GE(kept, kMany);
  EXPECT_TRUE(gives_way(PointCloud(disc.leftCols(kept).eval()), {})) << "an outline";
  PointCloud weighted(Scatter(Wavy, kMany, kSigma, 0, 5));
  weighted.set_weights(Eigen::VectorXd::LinSpaced(kMany, 0.5, 2));
  EXPECT_TRUE(gives_way(weighted, {})) << "weights";
  SurfaceFitOptions joint;
  joint.optimize = FreeVariables{.parameters = true};
  joint.control_points = std::pair(6, 6);
  EXPECT_TRUE(gives_way(PointCloud(Scatter(Wavy, kMany, kSigma, 0, 6)), joint))
      << "free parameters";
}

TEST(FitBySumsTest, ManyPointsAreFittedSo) {
  const PointCloud cloud(Scatter(Wavy, 240000, kSigma, 0, 7));
  StageClock clock;
  const std::optional<SurfaceFit> sums = FitBySums(cloud, {}, 60000, clock);
  ASSERT_TRUE(sums);
  EXPECT_EQ(FitSurface(cloud).surface.control_points(), sums->surface.control_points());
}

}  // namespace batten::internal::fit_by_sums_test
