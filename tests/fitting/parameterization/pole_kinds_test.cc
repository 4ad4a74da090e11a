// SPDX-License-Identifier: MIT
#include "fitting/parameterization/pole_kinds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "closed_shapes.h"

namespace batten::internal::pole_kinds_test {

constexpr double kDegree = std::numbers::pi / 180;

// A cone from its tip on.
TurnedShape Tip(double half_angle) {
  return {.name = "tip of " + std::to_string(half_angle) + " degrees",
          .profile = [=](double v) -> Eigen::Vector2d {
            return v *
                   Eigen::Vector2d(std::sin(half_angle * kDegree), std::cos(half_angle * kDegree));
          },
          .length = 2,
          .pole_start = true};
}

// The kinds found over the true parameters.
Poles KindsOf(const TurnedShape& shape,
              double sigma,
              Eigen::Index count,
              std::uint64_t seed,
              int threads = 2) {
  ThreadPool pool(threads);
  const TurnedPoints cloud = PointsOn(shape, count, sigma, seed);
  const double around = shape.Area() / shape.length / shape.angle;  // mean radius
  Parameterization base;
  base.name = "revolution";
  base.shape = "a surface of revolution";
  base.length_u = shape.angle * around;
  base.length_v = shape.length;
  base.parameters = Eigen::Vector2d(around, 1).asDiagonal() * cloud.parameters;
  base.periodic_u = shape.turned_all_round();
  base.poles.turn = shape.angle;
  if (shape.pole_start) base.poles.start = PoleKind::kSmooth;
  if (shape.pole_end) base.poles.end = PoleKind::kSmooth;
  const PointCloud points(cloud.points);
  std::vector<Eigen::Index> all(static_cast<size_t>(count));
  std::iota(all.begin(), all.end(), 0);
  const SurfaceFitOptions options;
  const BaseScore score(points, all, options, pool);
  const PointMask every = PointMask::Constant(count, true);
  return PolesByData(base, points, score.sample(), score.Of(base, every), pool);
}

void ExpectKinds(const TurnedShape& shape, double sigma, PoleKind start, PoleKind end) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(shape.name + ", sigma " + std::to_string(sigma) + ", seed " +
                 std::to_string(seed));
    const Poles poles = KindsOf(shape, sigma, 6000, seed);
    EXPECT_EQ(poles.start, start);
    EXPECT_EQ(poles.end, end);
    EXPECT_EQ(poles.turn, shape.angle);
  }
}

TEST(PolesByDataTest, ATipIsAnApex) {
  for (const double half_angle : {15, 45, 70}) {
    for (const double sigma : {1e-4, 2e-3, 1e-2}) {
      ExpectKinds(Tip(half_angle), sigma, PoleKind::kApex, PoleKind::kNone);
    }
  }
}

TEST(PolesByDataTest, ATipOfPartOfATurnIsAnApex) {
  ExpectKinds(PieceOf(Tip(45)), 2e-3, PoleKind::kApex, PoleKind::kNone);
}

TEST(PolesByDataTest, WhatIsRoundIsSmooth) {
  for (const double sigma : {1e-4, 2e-3, 1e-2}) {
    ExpectKinds(WholeSphere(), sigma, PoleKind::kSmooth, PoleKind::kSmooth);
    ExpectKinds(Egg(), sigma, PoleKind::kSmooth, PoleKind::kSmooth);
    ExpectKinds(Cup(), sigma, PoleKind::kSmooth, PoleKind::kNone);
  }
}

// What is nearly a plane has a tangent plane at the tip, as good as.
TEST(PolesByDataTest, AFlatTipIsSmooth) {
  ExpectKinds(Tip(87), 1e-3, PoleKind::kSmooth, PoleKind::kNone);
}

TEST(PolesByDataTest, ThereIsNoneWhereThereWasNone) {
  ExpectKinds(CylinderShapeOf(), 2e-3, PoleKind::kNone, PoleKind::kNone);
}

TEST(PolesByDataTest, OneEndOfEachKind) {
  // A drop: below a tip of 90 degrees, round above.
  const TurnedShape drop{.name = "drop",
                         .profile = [](double v) -> Eigen::Vector2d {
                           return {0.6 * std::sin(v), 1.2 * std::sin(v / 2)};
                         },
                         .length = std::numbers::pi,
                         .pole_start = true,
                         .pole_end = true};
  ExpectKinds(drop, 2e-3, PoleKind::kApex, PoleKind::kSmooth);
}

TEST(PolesByDataTest, IsTheSameForEveryNumberOfThreads) {
  for (const TurnedShape& shape : {Tip(45), WholeSphere()}) {
    EXPECT_EQ(KindsOf(shape, 2e-3, 4000, 5, 1), KindsOf(shape, 2e-3, 4000, 5, 3));
  }
}

}  // namespace batten::internal::pole_kinds_test
