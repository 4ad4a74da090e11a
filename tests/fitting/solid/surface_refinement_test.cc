// SPDX-License-Identifier: MIT
#include "fitting/solid/surface_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "body_clouds.h"
#include "geometry/subdivision/catmull_clark.h"

namespace batten::internal::surface_refinement_test {

constexpr double kNoise = 1e-3;

// A ball with two bumps that its surface is too coarse for.
struct TwoBumps {
  explicit TwoBumps(double height) : pool(1), mesh(CubeSphere(2)), stencils(mesh) {
    data.points = SpherePoints(6000, 0).colwise().normalized();
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    for (auto point : data.points.colwise()) {
      const double angle = std::acos(std::min(1.0, std::abs(point.dot(tip))));
      point *= 1 + height * std::exp(-angle * angle / (2 * 0.1 * 0.1)) + kNoise * normal(random);
    }
    data.normals = data.points.colwise().normalized();
    data.oriented = true;
    data.weights = Eigen::VectorXd::Ones(data.points.cols());
    data.left_out = EveryTenth(data.points.cols());
    fit = FitLimitSurface(
        stencils, ControlPointsThrough(mesh, CubeSphere(2).vertices), data, {}, pool);
  }

  std::optional<RefinedSurface> Refined(const std::vector<char>& barred) {
    return RefineSurface({stencils, fit, data, {}}, barred, std::nullopt, {}, pool);
  }

  // How far control points moved from those of the mesh subdivided, at most about a place.
  double MovedAbout(const RefinedSurface& refined, const Eigen::Vector3d& place) const {
    const Eigen::Matrix3Xd before = Combined(stencils.finer().stencils, fit.control_points);
    double most = 0;
    for (Eigen::Index v = 0; v < before.cols(); ++v) {
      if ((before.col(v) - place).norm() > 0.3) continue;
      most = std::max(most, (refined.fit.control_points.col(v) - before.col(v)).norm());
    }
    return most;
  }

  const Eigen::Vector3d tip = Eigen::Vector3d(2, 1, 3).normalized();
  ThreadPool pool;
  QuadTopology mesh;
  LimitStencils stencils;
  SurfaceData data;
  LimitSurfaceFit fit;
};

TEST(RefineSurfaceTest, MovesWhatMissesPointsAndIsNotBarred) {
  TwoBumps bumps(0.05);
  const auto both = bumps.Refined({});
  ASSERT_TRUE(both);
  EXPECT_GT(bumps.MovedAbout(*both, bumps.tip), 1e-3);
  EXPECT_GT(bumps.MovedAbout(*both, -bumps.tip), 1e-3);
  const Eigen::Vector3d side = bumps.tip.unitOrthogonal();
  EXPECT_EQ(bumps.MovedAbout(*both, side), 0);
  EXPECT_LT(both->free, both->fit.control_points.cols() / 2);

  std::vector<char> barred;
  const CoarseSurface coarse{bumps.stencils, bumps.fit, bumps.data, {}};
  EXPECT_TRUE(BarAbout(coarse, bumps.tip, bumps.pool, barred));
  EXPECT_FALSE(BarAbout(coarse, bumps.tip, bumps.pool, barred));
  const auto one = bumps.Refined(barred);
  ASSERT_TRUE(one);
  EXPECT_LT(bumps.MovedAbout(*one, bumps.tip), bumps.MovedAbout(*both, bumps.tip));
  EXPECT_GT(bumps.MovedAbout(*one, -bumps.tip), 1e-3);
  EXPECT_LT(one->free, both->free);

  EXPECT_FALSE(bumps.Refined(std::vector<char>(barred.size(), 1)));
}

TEST(RefineSurfaceTest, LeavesASurfaceThatMeetsItsPoints) { EXPECT_FALSE(TwoBumps(0).Refined({})); }

}  // namespace batten::internal::surface_refinement_test
