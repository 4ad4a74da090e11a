// SPDX-License-Identifier: MIT
// Whole fits of closed shapes under the options a user may set.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "batten/fitting/fit_surface.h"
#include "closed_oracle.h"
#include "tolerances.h"

namespace batten::internal::closed_options_test {

using ::testing::HasSubstr;

constexpr Eigen::Index kPoints = 5000;

double SigmaOf(const TurnedShape& shape) { return 1e-3 * shape.Size(); }

Eigen::Matrix3Xd CloudOf(const TurnedShape& shape, std::uint64_t seed = 1) {
  return PointsOn(shape, kPoints, SigmaOf(shape), seed).points;
}

SurfaceFit Fit(const Eigen::Matrix3Xd& points, SurfaceFitOptions options = {}) {
  if (options.threads == 0) options.threads = 2;
  return FitSurface(PointCloud::FromWorld(points), options);
}

std::string RefusalOf(const Eigen::Matrix3Xd& points, const SurfaceFitOptions& options) {
  try {
    Fit(points, options);
    return "fitted";
  } catch (const std::invalid_argument& refusal) {
    return refusal.what();
  }
}

ShapeError TruthError(const SurfaceFit& fit, const TurnedShape& shape) {
  return ErrorOfShape(fit.surface, TruthOn(shape, 3000, shape.SpacingOf(kPoints)).points);
}

std::vector<TurnedShape> Shapes() { return {CylinderShapeOf(), WholeSphere(), TorusShapeOf()}; }

void ExpectNoSeam(const NurbsSurface& surface) {
  for (const bool in_u : {true, false}) {
    const SplineBasis& basis = in_u ? surface.basis_u() : surface.basis_v();
    if (!basis.periodic()) continue;
    SCOPED_TRACE(in_u ? "across u" : "across v");
    const SeamJump jump = JumpAcross(surface, in_u);
    EXPECT_LE(jump.position, kRounding);
    if (basis.degree() >= 2) {
      EXPECT_LE(jump.normal, 1e2 * kRounding);
      EXPECT_LE(jump.first, 1e2 * kRounding);
    }
    if (basis.degree() >= 3) {
      EXPECT_LE(jump.second, 1e3 * kRounding);
    }
  }
}

void ExpectClosedAs(const SurfaceFit& fit, const TurnedShape& shape) {
  EXPECT_EQ(fit.report.geometry.closed,
            (std::vector<bool>{shape.turned_all_round(), shape.profile_closed}));
  EXPECT_EQ(fit.surface.basis_u().periodic(), shape.turned_all_round());
  EXPECT_EQ(fit.surface.basis_v().periodic(), shape.profile_closed);
  EXPECT_EQ(int{HasPole(fit.surface, true)} + int{HasPole(fit.surface, false)}, shape.poles());
  ExpectNoSeam(fit.surface);
}

// The largest distance between opposite edges.
double GapBetweenEdges(const NurbsSurface& surface, bool in_u) {
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  double gap = 0;
  for (int i = 0; i <= 100; ++i) {
    const double a = u.lower() + (u.upper() - u.lower()) * i / 100;
    const double b = v.lower() + (v.upper() - v.lower()) * i / 100;
    const Eigen::Vector3d way = in_u ? surface.At(u.lower(), b) - surface.At(u.upper(), b)
                                     : surface.At(a, v.lower()) - surface.At(a, v.upper());
    gap = std::max(gap, way.norm());
  }
  return gap;
}

// Each edge is off by the noise at a border, some σ √(n/N) that the largest of many may double.
TEST(ClosedOptionsTest, CutsAClosedShapeOpenWhereTold) {
  for (const TurnedShape& shape : Shapes()) {
    SCOPED_TRACE(shape.name);
    const SurfaceFit fit = Fit(CloudOf(shape), {.closed = Closing::kNone});
    EXPECT_EQ(fit.report.geometry.closed, (std::vector<bool>{false, false}));
    for (const SplineBasis* basis : {&fit.surface.basis_u(), &fit.surface.basis_v()}) {
      EXPECT_FALSE(basis->periodic());
      EXPECT_EQ(basis->knots().front(), basis->lower());  // clamped
      EXPECT_EQ(basis->knots().back(), basis->upper());
    }
    EXPECT_LE(GapBetweenEdges(fit.surface, true), 2 * SigmaOf(shape));
    if (shape.profile_closed) {
      EXPECT_LE(GapBetweenEdges(fit.surface, false), 2 * SigmaOf(shape));
    }
    EXPECT_LE(TruthError(fit, shape).max, 2 * SigmaOf(shape));
    EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
  }
}

TEST(ClosedOptionsTest, ClosesTheDirectionsAskedForAndNoOther) {
  const TurnedShape torus = TorusShapeOf(), sphere = WholeSphere();
  for (const auto& [closed, u, v] : {std::tuple{Closing::kU, true, false},
                                     std::tuple{Closing::kV, false, true},
                                     std::tuple{Closing::kBoth, true, true}}) {
    SCOPED_TRACE(static_cast<int>(closed));
    const SurfaceFit fit = Fit(CloudOf(torus), {.closed = closed});
    EXPECT_EQ(fit.report.geometry.closed, (std::vector<bool>{u, v}));
    EXPECT_EQ(fit.surface.basis_u().periodic(), u);
    EXPECT_EQ(fit.surface.basis_v().periodic(), v);
    ExpectNoSeam(fit.surface);
    EXPECT_LE(TruthError(fit, torus).max, 2 * SigmaOf(torus));
    if (v) {
      EXPECT_THAT(RefusalOf(CloudOf(sphere), {.closed = closed}), HasSubstr("do not close"));
    }
  }
  EXPECT_EQ(Fit(CloudOf(sphere), {.closed = Closing::kU}).surface, Fit(CloudOf(sphere)).surface);
}

TEST(ClosedOptionsTest, FitsInEveryDegree) {
  for (const int degree : {1, 2, 5}) {
    for (const TurnedShape& shape : Shapes()) {
      SCOPED_TRACE(shape.name + ", degree " + std::to_string(degree));
      const SurfaceFit fit = Fit(CloudOf(shape), {.degree_u = degree, .degree_v = degree});
      ExpectClosedAs(fit, shape);
      EXPECT_EQ(fit.surface.basis_u().degree(), degree);
      EXPECT_EQ(fit.surface.basis_v().degree(), degree);
      EXPECT_LE(fit.report.error.rms, 1.05 * SigmaOf(shape));
      // Facets need many cells, each with its share of the noise.
      EXPECT_LE(TruthError(fit, shape).rms, (degree == 1 ? 1.0 : 0.3) * SigmaOf(shape));
    }
  }
}

TEST(LongClosedOptionsTest, FitsInDegreesThatDiffer) {
  for (const auto& [p, q] : {std::pair{2, 4}, {4, 2}, {1, 3}, {3, 1}}) {
    SCOPED_TRACE(std::to_string(p) + ", " + std::to_string(q));
    for (const TurnedShape& shape : {WholeSphere(), Egg()}) {
      SCOPED_TRACE(shape.name);
      const SurfaceFit fit = Fit(CloudOf(shape), {.degree_u = p, .degree_v = q});
      ExpectClosedAs(fit, shape);
      EXPECT_LE(fit.report.error.rms, 1.05 * SigmaOf(shape));
    }
  }
}

// About a pole of degree two and more there is a tangent plane.
TEST(ClosedOptionsTest, PolesHaveNormalsInEveryDegreeFromTwo) {
  for (const int degree : {2, 3, 5}) {
    SCOPED_TRACE(degree);
    const SurfaceFit fit = Fit(CloudOf(WholeSphere()), {.degree_u = degree, .degree_v = degree});
    for (const bool start : {true, false}) {
      const PoleView pole = ViewPole(fit.surface, start);
      ASSERT_TRUE(pole.has_normals);
      EXPECT_LE(pole.spread, std::numbers::pi / 180);
      EXPECT_GE(std::abs(pole.normal.dot(pole.point.normalized())),
                std::cos(2 * std::numbers::pi / 180));
      EXPECT_NEAR(pole.point.norm(), 1, SigmaOf(WholeSphere()));
    }
  }
}

// Counts are those of the net as it is, repeats included.
TEST(ClosedOptionsTest, KeepsTheControlPointsItIsTold) {
  for (const TurnedShape& shape : Shapes()) {
    SCOPED_TRACE(shape.name);
    const SurfaceFit fit = Fit(CloudOf(shape), {.control_points = std::pair{17, 12}});
    ExpectClosedAs(fit, shape);
    EXPECT_EQ(fit.surface.size_u(), 17);
    EXPECT_EQ(fit.surface.size_v(), 12);
    EXPECT_EQ(fit.report.geometry.control_points, (std::vector<int>{17, 12}));
  }
}

// Round a circle fewer than degree + 1 cells would meet themselves: 2 p + 1 with the repeats.
TEST(ClosedOptionsTest, RefusesTooFewControlPointsForADirectionThatCloses) {
  for (const std::pair<int, int>& few : {std::pair{4, 12}, {6, 12}}) {
    SCOPED_TRACE(few.first);
    for (const TurnedShape& shape : Shapes()) {
      SCOPED_TRACE(shape.name);
      const std::string refusal = RefusalOf(CloudOf(shape), {.control_points = few});
      EXPECT_THAT(refusal, HasSubstr("control"));
      EXPECT_THAT(refusal, HasSubstr("at least 7"));
    }
  }
  EXPECT_THAT(RefusalOf(CloudOf(TorusShapeOf()), {.control_points = std::pair{12, 6}}),
              HasSubstr("at least 7"));
  EXPECT_EQ(RefusalOf(CloudOf(TorusShapeOf()), {.control_points = std::pair{7, 7}}), "fitted");
}

void ExpectToKeepATolerance(const std::vector<TurnedShape>& shapes) {
  for (const TurnedShape& shape : shapes) {
    SCOPED_TRACE(shape.name);
    const double tolerance = 0.5 * SigmaOf(shape);
    const Eigen::Matrix3Xd points =
        PointsOn(shape, kPoints, 0.02 * tolerance, 3).points;  // nearly exact
    const SurfaceFit fit = Fit(points, {.tolerance = tolerance});
    EXPECT_EQ(fit.report.tolerance_reached(), true);
    ExpectClosedAs(fit, shape);
    ThreadPool pool(2);
    EXPECT_LE(DistancesTo(fit.surface, points, pool).distances.cwiseAbs().maxCoeff(),
              tolerance * (1 + kHalfDigits));
    const SurfaceFit finer = Fit(points, {.tolerance = tolerance / 5});
    EXPECT_EQ(finer.report.tolerance_reached(), true);
    ExpectClosedAs(finer, shape);
  }
}

TEST(ClosedOptionsTest, KeepsAToleranceWithoutASeam) { ExpectToKeepATolerance({WholeSphere()}); }

TEST(LongClosedOptionsTest, KeepsAToleranceWithoutASeam) {
  ExpectToKeepATolerance({RippledVase(), OvalRing()});
}

TEST(ClosedOptionsTest, SaysSoWhenTheToleranceIsBelowTheNoise) {
  for (const TurnedShape& shape : Shapes()) {
    SCOPED_TRACE(shape.name);
    const SurfaceFit fit = Fit(CloudOf(shape), {.tolerance = 0.1 * SigmaOf(shape)});
    EXPECT_EQ(fit.report.tolerance_reached(), false);
    EXPECT_NE(fit.report.termination, Termination::kToleranceReached);
    ExpectClosedAs(fit, shape);
  }
}

// Every fiftieth point off by thirty sigma along the normal, and what losses make of it.
TEST(ClosedOptionsTest, EveryLossPassesOverStrays) {
  for (const TurnedShape& shape : {WholeSphere(), TorusShapeOf()}) {
    SCOPED_TRACE(shape.name);
    TurnedPoints cloud = PointsOn(shape, kPoints, SigmaOf(shape), 5);
    const double clean = TruthError(Fit(cloud.points), shape).rms;
    for (Eigen::Index k = 0; k < kPoints; k += 50) {
      cloud.points.col(k) +=
          30 * SigmaOf(shape) * shape.NormalAt(cloud.parameters(0, k), cloud.parameters(1, k));
    }
    for (const Loss loss : {Loss::kHuber, Loss::kCauchy, Loss::kTukey}) {
      SCOPED_TRACE(static_cast<int>(loss));
      const SurfaceFit fit = Fit(cloud.points, {.loss = loss});
      ExpectClosedAs(fit, shape);
      EXPECT_LE(TruthError(fit, shape).rms, 1.2 * clean);
    }
    const SurfaceFit all = Fit(cloud.points, {.keep_outliers = true});
    EXPECT_EQ(all.report.input.outliers, 0);
    EXPECT_FALSE(all.outliers.any());
  }
}

// A hole 20 spacings wide: a flat lid would be off by its half angle squared over two.
TEST(ClosedOptionsTest, StaysCalmOverARoundHoleInASphere) {
  const TurnedShape sphere = WholeSphere();
  const double half = 10 * sphere.SpacingOf(kPoints), lid = half * half / 2;
  for (const double degrees : {0, 40, 90}) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      SCOPED_TRACE(std::to_string(degrees) + " degrees from the pole, seed " +
                   std::to_string(seed));
      const double tilt = degrees * std::numbers::pi / 180;
      const Eigen::Vector3d centre(std::sin(tilt), 0, std::cos(tilt));
      const Eigen::Matrix3Xd all = CloudOf(sphere, seed);
      Eigen::Matrix3Xd points(3, kPoints);
      Eigen::Index kept = 0;
      for (const auto& p : all.colwise()) {
        if (p.normalized().dot(centre) < std::cos(half)) points.col(kept++) = p;
      }
      const SurfaceFit fit = Fit(points.leftCols(kept));
      EXPECT_EQ(fit.report.geometry.base, "sphere");
      const Eigen::Matrix3Xd truth = TruthOn(sphere, 4000, 0).points;
      if (HasPole(fit.surface, true) && HasPole(fit.surface, false)) {
        EXPECT_LE(ErrorOfShape(fit.surface, truth).max, lid / 2);
        EXPECT_LE(ErrorOfSurface(fit.surface, sphere, 0).max, lid / 2);
      } else {  // open at the hole
        Eigen::Matrix3Xd near = truth;
        Eigen::Index count = 0;
        for (const auto& p : truth.colwise()) {
          if (p.dot(centre) < std::cos(half)) near.col(count++) = p;
        }
        EXPECT_LE(ErrorOfShape(fit.surface, near.leftCols(count)).max, 3 * SigmaOf(sphere));
      }
      // No pole where there are points round it but none at it.
      for (const bool start : {true, false}) {
        if (!HasPole(fit.surface, start)) continue;
        const PoleView pole = ViewPole(fit.surface, start);
        EXPECT_LE((points.leftCols(kept).colwise() - pole.point).colwise().norm().minCoeff(),
                  3 * sphere.SpacingOf(kPoints));
      }
    }
  }
}

TEST(ClosedOptionsTest, SameThreadsSameBits) {
  for (const TurnedShape& shape : {CylinderShapeOf(), WholeSphere()}) {
    SCOPED_TRACE(shape.name);
    const Eigen::Matrix3Xd points = WithOutliersInBox(CloudOf(shape, 9), kPoints / 20, 4);
    for (const int threads : {1, 2}) {
      const SurfaceFit one = Fit(points, {.threads = threads}),
                       other = Fit(points, {.threads = threads});
      EXPECT_EQ(one.surface, other.surface);
      EXPECT_EQ(one.residuals, other.residuals);
    }
  }
}

// Far away coordinates are known to 1e-9: nothing beside the noise of 1e-3.
void ExpectTheSameFarAwayAndInOtherUnits(const std::vector<TurnedShape>& shapes) {
  for (const TurnedShape& shape : shapes) {
    SCOPED_TRACE(shape.name);
    const Eigen::Matrix3Xd points = CloudOf(shape, 11);
    const SurfaceFit plain = Fit(points);
    const Eigen::Matrix3Xd truth = TruthOn(shape, 2000, shape.SpacingOf(kPoints)).points;
    const double error = ErrorOfShape(plain.surface, truth).rms;
    for (const auto& [unit, away] :
         {std::pair{1.0, 5e6}, std::pair{1e-6, 0.0}, std::pair{1e6, 0.0}}) {
      SCOPED_TRACE("unit " + std::to_string(unit));
      const Eigen::Vector3d shift(away, -away / 2, away / 100);
      const SurfaceFit moved = Fit((unit * points).colwise() + shift);
      EXPECT_EQ(moved.report.geometry.base, plain.report.geometry.base);
      EXPECT_EQ(moved.report.geometry.closed, plain.report.geometry.closed);
      EXPECT_EQ(HasPole(moved.surface, true) + HasPole(moved.surface, false),
                HasPole(plain.surface, true) + HasPole(plain.surface, false));
      EXPECT_LE(ErrorOfShape(moved.surface, (unit * truth).colwise() + shift).rms,
                1.15 * unit * error);
    }
  }
}

TEST(ClosedOptionsTest, FarAwayAndInOtherUnitsTheFitIsTheSame) {
  ExpectTheSameFarAwayAndInOtherUnits({SteepCone()});
}

TEST(LongClosedOptionsTest, FarAwayAndInOtherUnitsTheFitIsTheSame) {
  ExpectTheSameFarAwayAndInOtherUnits({Egg(), OvalRing(), PipeElbow(90)});
}

}  // namespace batten::internal::closed_options_test
