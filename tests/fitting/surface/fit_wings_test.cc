// SPDX-License-Identifier: MIT
// Whole fits of thin closed sections with a sharp edge, nothing given but the points.
#include <gtest/gtest.h>

#include <string>

#include "batten/fitting/distances.h"
#include "batten/fitting/fit_surface.h"
#include "wings.h"

namespace batten::internal::fit_wings_test {

struct Case {
  WingShape shape;
  Eigen::Index count;
  double sigma;
};

// Law: the surface closes at the edge, bit for bit; the points are fitted to their noise; and the
// truth is much nearer than the points are, the edge within two spacings.
void ClosesAtTheEdgeAndFitsToTheNoise(const Case& one, unsigned seed) {
  SCOPED_TRACE(seed);
  const WingMap map = MapOf(one.shape);
  const WingCloud cloud = PointsOverWing(map, one.count, one.sigma, seed);
  const SurfaceFit fit = FitSurface(PointCloud::FromWorld(cloud.points));
  const NurbsSurface& surface = fit.surface;
  EXPECT_EQ(fit.report.base_candidates.back().name, "wing");
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  const Eigen::Index row = v.size(), last = Eigen::Index{u.size() - 1} * row;
  const Eigen::Matrix3Xd& net = surface.control_points();
  EXPECT_EQ(net.leftCols(row), net.middleCols(last, row));
  EXPECT_LT(fit.report.error.rms, 1.1 * one.sigma);
  EXPECT_LT(fit.report.input.outliers, one.count / 500);
  ThreadPool pool(2);
  constexpr int kSide = 40;
  Eigen::Matrix3Xd truth(3, kSide * kSide), edge(3, kSide);
  for (int i = 0; i < kSide; ++i) {
    edge.col(i) = map(0, (i + 0.5) / kSide);
    for (int j = 0; j < kSide; ++j)
      truth.col(i * kSide + j) = map((i + 0.5) / kSide, (j + 0.5) / kSide);
  }
  const Eigen::VectorXd off = DistancesTo(surface, truth, pool).distances;
  EXPECT_LT(std::sqrt(off.squaredNorm() / static_cast<double>(off.size())), one.sigma / 3);
  const Eigen::VectorXd short_by = DistancesTo(surface, edge, pool).distances;
  EXPECT_LT(short_by.cwiseAbs().maxCoeff(), 2 * fit.report.input.spacing);
}

TEST(FitWingsTest, ATwistedOneClosesAtTheEdgeAndIsFittedToTheNoise) {
  ClosesAtTheEdgeAndFitsToTheNoise(
      {{.thickness = 0.16, .camber = 0.03, .taper = 0.7, .twist = 0.1}, 25000, 8e-4}, 12);
}

TEST(LongFitWingsTest, CloseAtTheEdgeAndFitToTheNoise) {
  ClosesAtTheEdgeAndFitsToTheNoise({{}, 30000, 5e-4}, 11);
  ClosesAtTheEdgeAndFitsToTheNoise(
      {{.thickness = 0.1, .camber = 0, .span = 3, .sweep = 0.6}, 40000, 3e-4}, 13);
}

// Law: where points lie on one sheet, nothing of this is tried.
TEST(FitWingsTest, OneSheetIsNoWing) {
  const auto sheet = [](double u, double v) {
    return Eigen::Vector3d(u, v, 0.1 * std::sin(3 * u) * std::cos(2 * v));
  };
  const SurfaceFit fit =
      FitSurface(PointCloud::FromWorld(PointsOverWing(sheet, 10000, 5e-4, 8).points));
  for (const BaseCandidate& row : fit.report.base_candidates) EXPECT_NE(row.name, "wing");
}

}  // namespace batten::internal::fit_wings_test
