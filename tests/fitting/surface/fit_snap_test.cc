// SPDX-License-Identifier: MIT
// Whole fits that may end in an exact shape.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "batten/fitting/fit_surface.h"
#include "closed_shapes.h"

namespace batten::internal::fit_snap_test {

using ::testing::HasSubstr;

constexpr double kSigma = 2e-3;

SurfaceFit Snapped(const Eigen::Matrix3Xd& points, SurfaceFitOptions options = {}) {
  options.snap = true;
  options.threads = 2;
  return FitSurface(PointCloud::FromWorld(points), options);
}

Eigen::Matrix3Xd CloudOf(const TurnedShape& shape, std::uint64_t seed = 1) {
  return PointsOn(shape, 6000, kSigma, seed).points;
}

TEST(FitSnapTest, TakesTheExactShapeThatExplainsThePointsAsWell) {
  const struct {
    TurnedShape shape;
    const char* kind;
    std::vector<bool> closed;
  } cases[] = {{CylinderShapeOf(), "cylinder", {true, false}},
               {SteepCone(), "cone", {true, false}},
               {WholeSphere(), "sphere", {true, false}},
               {TorusShapeOf(), "torus", {true, true}}};
  for (const auto& [shape, kind, closed] : cases) {
    SCOPED_TRACE(kind);
    const SurfaceFit fit = Snapped(CloudOf(shape));
    ASSERT_TRUE(fit.report.geometry.primitive);
    EXPECT_EQ(fit.report.geometry.primitive->kind, kind);
    EXPECT_THAT(fit.report.geometry.base_why, HasSubstr("snapped"));
    EXPECT_EQ(fit.report.geometry.closed, closed);
    EXPECT_EQ(fit.report.geometry.degree[0], fit.surface.basis_u().degree());
    EXPECT_TRUE(fit.surface.rational());
    // Noise of so many points, its own scatter granted.
    EXPECT_NEAR(fit.report.error.rms, kSigma, 0.05 * kSigma);
  }
}

TEST(FitSnapTest, LeavesWhatNoExactShapeExplains) {
  for (const TurnedShape& shape : {RippledVase(), Egg(), OvalRing()}) {
    SCOPED_TRACE(shape.name);
    const SurfaceFit fit = Snapped(CloudOf(shape));
    EXPECT_FALSE(fit.report.geometry.primitive);
    EXPECT_FALSE(fit.surface.rational());
    EXPECT_THAT(fit.report.geometry.base_why, HasSubstr("no plane, sphere"));
  }
}

TEST(FitSnapTest, NumbersAreInTheCoordinatesOfTheResult) {
  const Eigen::Vector3d far(4e5, 5e6, -300), shift(4e5, 5e6, 0);
  SurfaceFitOptions options;
  options.shift = shift;
  const SurfaceFit fit = Snapped(CloudOf(WholeSphere()).colwise() + far, options);
  ASSERT_TRUE(fit.report.geometry.primitive);
  const PrimitiveSummary& sphere = *fit.report.geometry.primitive;
  ASSERT_TRUE(sphere.center && sphere.radius);
  const Eigen::Vector3d middle = (fit.surface.control_points().rowwise().maxCoeff() +
                                  fit.surface.control_points().rowwise().minCoeff()) /
                                 2;
  EXPECT_LT((*sphere.center - (far - shift)).norm(), 10 * kSigma);
  EXPECT_LT((*sphere.center - middle).norm(), 0.5 * *sphere.radius);
}

TEST(FitSnapTest, KeepsATolerance) {
  SurfaceFitOptions options;
  options.tolerance = 6 * kSigma;
  const SurfaceFit snapped = Snapped(CloudOf(CylinderShapeOf()), options);
  EXPECT_TRUE(snapped.report.geometry.primitive);
  EXPECT_EQ(snapped.report.termination, Termination::kToleranceReached);
  options.snap = false;
  options.threads = 2;
  const SurfaceFit free_form =
      FitSurface(PointCloud::FromWorld(CloudOf(CylinderShapeOf())), options);
  EXPECT_FALSE(free_form.report.geometry.primitive);
}

}  // namespace batten::internal::fit_snap_test
