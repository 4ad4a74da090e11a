// SPDX-License-Identifier: MIT
#include "fitting/solid/surface_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "body_clouds.h"
#include "geometry/subdivision/catmull_clark.h"

namespace batten::internal::surface_refinement_test {

constexpr double kNoise = 1e-3;

// A ball with two bumps that its surface is too coarse for.
struct TwoBumps {
  explicit TwoBumps(double height, int points = 6000, double noise = kNoise)
      : pool(1), mesh(CubeSphere(2)), stencils(mesh) {
    data.points = SpherePoints(points, 0).colwise().normalized();
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    for (auto point : data.points.colwise()) {
      const double angle = std::acos(std::min(1.0, std::abs(point.dot(tip))));
      point *= 1 + height * std::exp(-angle * angle / (2 * 0.1 * 0.1)) + noise * normal(random);
    }
    data.normals = data.points.colwise().normalized();
    data.oriented = true;
    data.weights = Eigen::VectorXd::Ones(data.points.cols());
    data.left_out = EveryTenth(data.points.cols());
    Fit();
  }

  void Fit() {
    fit = FitLimitSurface(
        stencils, ControlPointsThrough(mesh, CubeSphere(2).vertices), data, {}, pool);
  }

  std::optional<RefinedSurface> Refined(const std::vector<char>& barred,
                                        std::optional<double> tolerance = std::nullopt) {
    return RefineSurface({stencils, fit, data, caps}, barred, tolerance, {}, pool);
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
  std::vector<int> caps;
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

// What only closes the surface stays as it is.
TEST(RefineSurfaceTest, LeavesCaps) {
  TwoBumps bumps(0.05);
  for (int f = 0; f < bumps.mesh.faces(); ++f) {
    const Eigen::Vector3d middle =
        CubeSphere(2).vertices(Eigen::all, bumps.mesh.corners().col(f)).rowwise().mean();
    if (middle.dot(bumps.tip) < -0.7) bumps.caps.push_back(f);
  }
  const auto refined = bumps.Refined({});
  ASSERT_TRUE(refined);
  EXPECT_EQ(refined->caps.size(), 4 * bumps.caps.size());
  EXPECT_GT(bumps.MovedAbout(*refined, bumps.tip), 1e-3);
  EXPECT_EQ(bumps.MovedAbout(*refined, -bumps.tip), 0);
}

// Three of them may be met better by chance.
TEST(RefineSurfaceTest, AsksForMorePointsLeftOutThanAFew) {
  TwoBumps bumps(0.05);
  int left_out = 0;
  for (Eigen::Index k = 0; k < bumps.data.points.cols(); ++k) {
    const bool near = bumps.data.points.col(k).normalized().dot(bumps.tip) > 0.98;
    bumps.data.left_out[k] = near && left_out++ < 3;
  }
  bumps.Fit();
  EXPECT_FALSE(bumps.Refined({}));
}

// A tolerance below the noise asks for all faces, which points left out refuse here; those that
// miss their points by more than noise are refined as without one.
TEST(RefineSurfaceTest, TolerancesBelowTheNoiseAreNoHindrance) {
  for (const auto& [points, noise] : {std::pair(800, 3e-3), std::pair(2000, 6e-3)}) {
    TwoBumps bumps(0.05, points, noise);
    const auto without = bumps.Refined({});
    const auto within = bumps.Refined({}, 1e-9);
    ASSERT_TRUE(without && within);
    EXPECT_EQ(within->fit.control_points, without->fit.control_points);
    bumps.data.noise = 1e-9;
    EXPECT_FALSE(bumps.Refined({}));
  }
}

TEST(RefineSurfaceTest, LeavesASurfaceThatMeetsItsPoints) { EXPECT_FALSE(TwoBumps(0).Refined({})); }

}  // namespace batten::internal::surface_refinement_test
