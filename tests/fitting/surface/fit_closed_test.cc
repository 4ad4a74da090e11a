// SPDX-License-Identifier: MIT
// Whole fits of shapes that go all round: what holds whatever the base.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/fit_surface.h"
#include "closed_oracle.h"
#include "tolerances.h"

namespace batten::internal::fit_closed_test {

constexpr double kNoiseOfSize = 1e-3;

struct ClosedCase {
  TurnedShape shape;
  std::vector<std::string> bases;  // any of them
};

std::vector<ClosedCase> ClosedCases() {
  return {{CylinderShapeOf(), {"revolution"}},
          {SteepCone(), {"revolution"}},
          {RippledVase(), {"revolution"}},
          {TorusShapeOf(), {"torus"}},
          {OvalRing(), {"torus", "revolution"}},
          {WholeSphere(), {"sphere"}},
          {Egg(), {"sphere", "revolution"}},
          {Cup(), {"sphere", "revolution"}},
          {PipeElbow(90), {"torus", "sheet"}},
          {PipeElbow(200), {"torus", "sheet"}}};
}

// A tube closes in u; over the other bases u runs about the axis.
std::vector<bool> ClosedOver(const std::string& base, const TurnedShape& shape) {
  if (base == "sheet") return {true, false};
  return {shape.turned_all_round(), shape.profile_closed};
}

// Turned somehow, as clouds come.
Eigen::Affine3d SomePose(double scale = 1,
                         const Eigen::Vector3d& shift = Eigen::Vector3d(3, -1, 2)) {
  Eigen::Affine3d pose = Eigen::Affine3d::Identity();
  pose.translate(shift);
  pose.rotate(Eigen::AngleAxisd(1.1, Eigen::Vector3d(2, -1, 0.6).normalized()));
  pose.scale(scale);
  return pose;
}

Eigen::Matrix3Xd Moved(const Eigen::Affine3d& pose, const Eigen::Matrix3Xd& points) {
  return (pose.linear() * points).colwise() + pose.translation();
}

double SigmaOf(const TurnedShape& shape) { return kNoiseOfSize * shape.Size(); }

Eigen::Matrix3Xd CloudOf(const TurnedShape& shape, Eigen::Index count, std::uint64_t seed = 1) {
  return PointsOn(shape, count, SigmaOf(shape), seed).points;
}

SurfaceFit Fit(const Eigen::Matrix3Xd& points, int threads = 2) {
  SurfaceFitOptions options;
  options.threads = threads;
  return FitSurface(PointCloud::FromWorld(points), options);
}

TEST(FitClosedTest, ClosesWhatIsClosedAndSaysSo) {
  for (const auto& [shape, bases] : ClosedCases()) {
    SCOPED_TRACE(shape.name);
    const SurfaceFit fit = Fit(Moved(SomePose(), CloudOf(shape, 6000)));
    const GeometrySummary& geometry = fit.report.geometry;
    EXPECT_NE(std::find(bases.begin(), bases.end(), geometry.base), bases.end()) << geometry.base;
    EXPECT_FALSE(geometry.base_why.empty());
    for (const BaseCandidate& one : fit.report.base_candidates)
      EXPECT_EQ(one.refused.empty(), one.name == geometry.base) << one.name << ": " << one.refused;
    EXPECT_GE(fit.report.base_candidates.size(), 3u);
    const std::vector<bool> closed = ClosedOver(geometry.base, shape);
    EXPECT_EQ(geometry.closed, closed);
    EXPECT_EQ(fit.surface.basis_u().periodic(), closed[0]);
    EXPECT_EQ(fit.surface.basis_v().periodic(), closed[1]);
    EXPECT_EQ(int{HasPole(fit.surface, true)} + int{HasPole(fit.surface, false)}, shape.poles());
    EXPECT_EQ(geometry.control_points,
              (std::vector<int>{fit.surface.size_u(), fit.surface.size_v()}));
    EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
    EXPECT_EQ(fit.report.input.outliers, fit.outliers.count());
    EXPECT_LE(fit.report.input.outliers, 6);  // a thousandth
    EXPECT_LE(fit.report.error.rms, 1.05 * SigmaOf(shape));
    EXPECT_GE(fit.report.error.rms, 0.9 * SigmaOf(shape));
  }
}

// Knots repeat to rounding, and control points exactly: derivatives of order k, over cells of a
// twentieth of the whole, are then as good as rounding times 20^k.
TEST(FitClosedTest, HasNoSeam) {
  for (const auto& [shape, bases] : ClosedCases()) {
    SCOPED_TRACE(shape.name);
    const SurfaceFit fit = Fit(CloudOf(shape, 6000, 2));
    for (const bool in_u : {true, false}) {
      if (!(in_u ? fit.surface.basis_u() : fit.surface.basis_v()).periodic()) continue;
      const SeamJump jump = JumpAcross(fit.surface, in_u);
      EXPECT_LE(jump.position, kRounding);
      EXPECT_LE(jump.normal, kRounding);
      EXPECT_LE(jump.first, kRounding);
      EXPECT_LE(jump.second, 1e3 * kRounding);
    }
  }
}

// One normal at the pole from wherever one comes, near that of the shape, and isolines that leave
// it evenly: those of a plain collapsed row differ by some degrees.
TEST(FitClosedTest, IsSmoothAtItsPoles) {
  constexpr double kDegree = std::numbers::pi / 180;
  for (const TurnedShape& shape : {WholeSphere(), Egg(), Cup()}) {
    SCOPED_TRACE(shape.name);
    const SurfaceFit fit = Fit(CloudOf(shape, 8000, 3));
    for (const bool at_start : {true, false}) {
      if (!HasPole(fit.surface, at_start)) continue;
      const PoleView pole = ViewPole(fit.surface, at_start);
      ASSERT_TRUE(pole.has_normals);
      EXPECT_LE(pole.spread, 1 * kDegree);
      const TurnedFoot foot = FootOn(shape, pole.point);
      EXPECT_LE(foot.distance, SigmaOf(shape));
      const Eigen::Vector3d normal = shape.NormalAt(foot.u, std::max(foot.v, 1e-3));
      EXPECT_GE(std::abs(pole.normal.dot(normal)), std::cos(2 * kDegree));
      EXPECT_NEAR(std::abs(pole.turn), 2 * std::numbers::pi, kIterated);
      EXPECT_LE(pole.swirl, 10 * kDegree);
    }
  }
}

// The fit to moved points is the moved fit: where it differs, by far less than it differs from the
// truth, for where a seam lies is up to rounding.
TEST(FitClosedTest, FollowsACloudThatIsTurnedMovedFarAwayAndInOtherUnits) {
  for (const TurnedShape& shape : {CylinderShapeOf(), WholeSphere(), TorusShapeOf()}) {
    SCOPED_TRACE(shape.name);
    const Eigen::Matrix3Xd points = CloudOf(shape, 5000, 4);
    const Eigen::Matrix3Xd truth = TruthOn(shape, 2000, shape.SpacingOf(5000)).points;
    const SurfaceFit plain = Fit(points);
    const double error = ErrorOfShape(plain.surface, truth).rms;
    const Eigen::Vector3d far(5e6, -3e6, 4e3);
    for (const Eigen::Affine3d& pose :
         {SomePose(), SomePose(1, far), SomePose(1e-6), SomePose(1e6)}) {
      const double scale = std::cbrt(pose.linear().determinant());
      SCOPED_TRACE("scale " + std::to_string(scale));
      const SurfaceFit moved = Fit(Moved(pose, points));
      EXPECT_LE(ErrorOfShape(moved.surface, Moved(pose, truth)).rms, 1.15 * scale * error);
      EXPECT_NEAR(
          moved.report.error.rms, scale * plain.report.error.rms, 0.01 * scale * error * 20);
      EXPECT_EQ(moved.report.geometry.base, plain.report.geometry.base);
      EXPECT_EQ(moved.report.geometry.closed, plain.report.geometry.closed);
      EXPECT_EQ(moved.surface.basis_u().periodic(), plain.surface.basis_u().periodic());
      EXPECT_NEAR(FreePointsOf(moved.surface),
                  FreePointsOf(plain.surface),
                  0.25 * FreePointsOf(plain.surface));
    }
  }
}

TEST(FitClosedTest, IsTheSameForEveryNumberOfThreads) {
  for (const TurnedShape& shape : {RippledVase(), WholeSphere(), OvalRing(), PipeElbow(90)}) {
    SCOPED_TRACE(shape.name);
    const Eigen::Matrix3Xd points = CloudOf(shape, 4000, 5);
    const SurfaceFit one = Fit(points, 1), three = Fit(points, 3);
    EXPECT_EQ(one.surface, three.surface);
    EXPECT_TRUE((one.outliers == three.outliers).all());
  }
}

// The feet are those of the surface, whichever side of the seam a point lies on.
TEST(FitClosedTest, ReportsFeetAndDistancesOfTheSurfaceItself) {
  ThreadPool pool(2);
  for (const TurnedShape& shape : {CylinderShapeOf(), TorusShapeOf(), WholeSphere()}) {
    SCOPED_TRACE(shape.name);
    const Eigen::Matrix3Xd points = CloudOf(shape, 4000, 6);
    const SurfaceFit fit = Fit(points);
    const Eigen::VectorXd distances = DistancesTo(fit.surface, points, pool).distances;
    const double size = shape.Size();
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      EXPECT_NEAR(std::abs(fit.residuals[k]), std::abs(distances[k]), kIterated * size);
      const Eigen::Vector3d foot = fit.surface.At(fit.parameters(0, k), fit.parameters(1, k));
      EXPECT_NEAR((foot - points.col(k)).norm(), std::abs(distances[k]), kIterated * size);
    }
    EXPECT_NEAR(fit.report.error_all.rms, SummaryOf(distances).rms, kIterated * size);
  }
}

// Where a cylinder has no points all round, the surface stays where it would be.
TEST(FitClosedTest, StaysCalmOverAHoleInTheWall) {
  const TurnedShape shape = CylinderShapeOf();
  TurnedPoints cloud = PointsOn(shape, 8000, SigmaOf(shape), 7);
  Eigen::Index kept = 0;
  for (Eigen::Index k = 0; k < cloud.points.cols(); ++k) {
    const Eigen::Vector2d place = cloud.parameters.col(k);
    if (std::hypot(place[0] - std::numbers::pi, place[1] - 1.5) < 0.4) continue;
    cloud.points.col(kept++) = cloud.points.col(k);
  }
  const SurfaceFit fit =
      FitSurface(PointCloud(cloud.points.leftCols(kept)), {.trim = Trimming::kNone});
  EXPECT_EQ(fit.report.geometry.closed, (std::vector<bool>{true, false}));
  // A flat lid would be off by 0.4²/2 = 0.08.
  const Eigen::Matrix3Xd truth = TruthOn(shape, 4000, shape.SpacingOf(8000)).points;
  EXPECT_LE(ErrorOfShape(fit.surface, truth).max, 0.04);
}

// An edge of a roll passes over another part of it, but no way round leads back to its beginning.
TEST(FitClosedTest, LeavesOpenWhatOnlyLooksClosed) {
  // One turn and a half whose turns are 0.35 apart.
  const auto roll = [](double u) -> Eigen::Vector2d {
    const double radius = 1 + 0.35 * u / (2 * std::numbers::pi);
    return radius * Eigen::Vector2d(std::cos(u), std::sin(u));
  };
  const TurnedPoints flat = PointsOn(CylinderShapeOf(2), 8000, 0, 8);
  Eigen::Matrix3Xd points(3, 8000);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    points.col(k) << roll(1.5 * flat.parameters(0, k)), flat.parameters(1, k);
  }
  points += 2e-3 * Eigen::Matrix3Xd::Random(3, 8000);
  const SurfaceFit fit = Fit(points);
  EXPECT_EQ(fit.report.geometry.base, "sheet");
  EXPECT_EQ(fit.report.geometry.closed, (std::vector<bool>{false, false}));
  EXPECT_FALSE(fit.surface.basis_u().periodic());
}

// Its half angle is 20 degrees.
TurnedShape PointedCone() {
  const double half = std::numbers::pi / 9;
  return {.name = "pointed cone",
          .profile = [=](double v) -> Eigen::Vector2d {
            return v * Eigen::Vector2d(std::sin(half), std::cos(half));
          },
          .length = 2.9};
}

// With few control points the joint stage moves feet far along the surface, and an edge may draw
// back from the last points.
TEST(FitClosedTest, IsNotMadeWorseByTheJointStage) {
  for (const auto& [n, m] : {std::pair{9, 6}, {8, 7}, {9, 8}}) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      SCOPED_TRACE(std::to_string(n) + " by " + std::to_string(m) + ", seed " +
                   std::to_string(seed));
      SurfaceFitOptions options;
      options.threads = 2;
      options.control_points = {n, m};
      const OptimizeSummary joint =
          FitSurface(PointCloud::FromWorld(PointsOn(PointedCone(), 3000, 1e-3, seed).points),
                     options)
              .report.optimize;
      EXPECT_LE(joint.rms_after, joint.rms_before) << joint.why;
    }
  }
}

// Those that repeat others, or lie on a pole, count like any other.
TEST(FitClosedTest, HasNoMoreControlPointsThanAllowed) {
  for (const TurnedShape& shape : {CylinderShapeOf(), WholeSphere(), TorusShapeOf()}) {
    const PointCloud cloud = PointCloud::FromWorld(CloudOf(shape, 3000, 10));
    for (const int most : {28, 50, 90}) {
      SCOPED_TRACE(shape.name + ", " + std::to_string(most));
      SurfaceFitOptions options;
      options.threads = 2;
      options.max_control_points = most;
      // Closed in both directions it has seven times seven.
      if (shape.closed_directions() == 2 && most < 49) {
        EXPECT_THROW((void)FitSurface(cloud, options), std::invalid_argument);
        continue;
      }
      const NurbsSurface surface = FitSurface(cloud, options).surface;
      EXPECT_LE(surface.size_u() * surface.size_v(), most);
    }
  }
}

}  // namespace batten::internal::fit_closed_test
