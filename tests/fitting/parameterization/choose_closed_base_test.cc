// SPDX-License-Identifier: MIT
// Which base shapes get that close, and what is said where none or not the one asked for serves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "closed_shapes.h"
#include "fitting/parameterization/choose_parameterization.h"
#include "tubes.h"

namespace batten::internal::choose_closed_base_test {

using ::testing::AnyOf;
using ::testing::HasSubstr;

ParameterizationChoice Choose(const Eigen::Matrix3Xd& points,
                              SurfaceFitOptions options = {},
                              int threads = 2) {
  ThreadPool pool(threads);
  const NeighbourIndex index(points);
  return ChooseBase(
      PointCloud(points), index, MeasureCloud(points, index, {}, pool), options, pool);
}

std::string RefusalOf(const Eigen::Matrix3Xd& points, const SurfaceFitOptions& options) {
  try {
    const ParameterizationChoice choice = Choose(points, options);
    return "taken over a " + choice.base.name;
  } catch (const std::invalid_argument& refusal) {
    return refusal.what();
  }
}

Eigen::Matrix3Xd Noisy(const TurnedShape& shape, Eigen::Index count = 5000, unsigned seed = 1) {
  const Eigen::Matrix3d turn(
      Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix());
  return turn * PointsOn(shape, count, 1e-3 * shape.Size(), seed).points;
}

Eigen::Matrix3Xd Noisy(const BentSheet& sheet, Eigen::Index count = 5000, unsigned seed = 1) {
  return PointsOn(sheet, {.count = count, .sigma = 2e-3, .isotropic = true, .seed = seed}).points;
}

struct Kind {
  std::string name;
  Eigen::Matrix3Xd points;
  std::string base;
  bool closed_u = false, closed_v = false;
  int poles = 0;
};

std::vector<Kind> Kinds() {
  return {{"flat", Noisy(FlatSheet(2, 1)), "plane"},
          {"shell", Noisy(ShellSheet()), "sheet"},
          {"roll", Noisy(Roll()), "sheet"},
          {"sphere", Noisy(WholeSphere()), "sphere", true, false, 2},
          {"torus", Noisy(TorusShapeOf()), "torus", true, true},
          {"cylinder", Noisy(CylinderShapeOf()), "revolution", true},
          {"cone", Noisy(SteepCone()), "revolution", true},
          {"vase", Noisy(RippledVase()), "revolution", true},
          {"hose", Noisy(Hose()), "sheet", true},
          {"horn", Noisy(Horn()), "sheet", true}};
}

// The simplest that serves, in the order plane, sheet, sphere, torus, revolution, tube.
TEST(ChooseClosedBaseTest, TakesTheSimplestThatServes) {
  for (const Kind& kind : Kinds()) {
    SCOPED_TRACE(kind.name);
    const ParameterizationChoice choice = Choose(kind.points);
    EXPECT_EQ(choice.base.name, kind.base);
    EXPECT_EQ(choice.base.periodic_u, kind.closed_u);
    EXPECT_EQ(choice.base.periodic_v, kind.closed_v);
    const Poles& poles = choice.base.poles;
    EXPECT_EQ(int{poles.start != PoleKind::kNone} + int{poles.end != PoleKind::kNone}, kind.poles);
    EXPECT_FALSE(choice.base.why.empty());
    EXPECT_TRUE(choice.reached.all());
    EXPECT_TRUE(choice.warnings.empty());
    EXPECT_TRUE(choice.base.parameters.allFinite());
    EXPECT_GE(choice.base.parameters.minCoeff(), 0);
    EXPECT_LE(choice.base.parameters.row(0).maxCoeff(), choice.base.length_u);
    EXPECT_LE(choice.base.parameters.row(1).maxCoeff(), choice.base.length_v);
  }
}

// Laid out flat a fan leaves much of its rectangle empty.
TEST(ChooseClosedBaseTest, TakesAFanAsARevolution) {
  const ParameterizationChoice choice = Choose(Noisy(PieceOf(SteepCone(), 270)));
  EXPECT_EQ(choice.base.name, "revolution");
  EXPECT_FALSE(choice.base.periodic_u);
  EXPECT_FALSE(choice.base.periodic_v);
  EXPECT_FALSE(choice.base.poles.any());
}

TEST(ChooseClosedBaseTest, ASpiralOfATurnAndAHalfStaysAnOpenSheet) {
  for (const double apart : {0.15, 0.35}) {
    for (const unsigned seed : {1, 2, 3}) {
      SCOPED_TRACE("apart " + std::to_string(apart) + ", seed " + std::to_string(seed));
      const ParameterizationChoice choice = Choose(Noisy(Roll(1.5, apart, 0.8), 8000, seed));
      EXPECT_EQ(choice.base.name, "sheet");
      EXPECT_FALSE(choice.base.periodic_u || choice.base.periodic_v);
    }
  }
}

TEST(ChooseClosedBaseTest, TakesTheBaseItIsTold) {
  for (const auto& [shape, base, name] :
       {std::tuple{WholeSphere(), BaseShape::kRevolution, "revolution"},
        std::tuple{TorusShapeOf(), BaseShape::kRevolution, "revolution"},
        std::tuple{CylinderShapeOf(), BaseShape::kSheet, "sheet"},
        std::tuple{SteepCone(), BaseShape::kSheet, "sheet"}}) {
    SCOPED_TRACE(shape.name + " over a " + name);
    const ParameterizationChoice choice = Choose(Noisy(shape), {.base = base});
    EXPECT_EQ(choice.base.name, name);
    EXPECT_TRUE(choice.base.periodic_u);
    EXPECT_EQ(choice.base.periodic_v, shape.profile_closed);
    EXPECT_EQ(int{choice.base.poles.start == PoleKind::kSmooth} +
                  int{choice.base.poles.end == PoleKind::kSmooth},
              shape.poles());
  }
}

TEST(ChooseClosedBaseTest, SaysWhyTheBaseAskedForDoesNotServe) {
  const struct {
    std::string name;
    Eigen::Matrix3Xd points;
    BaseShape base;
    const char* why;
  } cases[] = {{"a cylinder", Noisy(CylinderShapeOf()), BaseShape::kSphere, "off every sphere"},
               {"a torus", Noisy(TorusShapeOf()), BaseShape::kSphere, "off every sphere"},
               {"a shell", Noisy(ShellSheet()), BaseShape::kSphere, "off every sphere"},
               {"a cylinder", Noisy(CylinderShapeOf()), BaseShape::kTorus, "off every torus"},
               {"a ball", Noisy(WholeSphere()), BaseShape::kTorus, "off every torus"},
               {"a shell", Noisy(ShellSheet()), BaseShape::kTorus, "half of a tube"},
               {"a plane", Noisy(FlatSheet(2, 1)), BaseShape::kRevolution, "lie in a plane"},
               {"a plane", Noisy(FlatSheet(2, 1)), BaseShape::kSphere, "lie in a plane"},
               {"a plane", Noisy(FlatSheet(2, 1)), BaseShape::kTorus, "lie in a plane"},
               {"a ball", Noisy(WholeSphere()), BaseShape::kSheet, "as a ball"},
               {"a torus", Noisy(TorusShapeOf()), BaseShape::kSheet, "as a torus"},
               {"a ball", Noisy(WholeSphere()), BaseShape::kPlane, "not a height field"},
               {"a cylinder", Noisy(CylinderShapeOf()), BaseShape::kPlane, "not a height field"},
               {"a band", Noisy(TwistedBand(1)), BaseShape::kSheet, "one-sided"}};
  for (const auto& [name, points, base, why] : cases) {
    SCOPED_TRACE(name + " over base " + std::to_string(static_cast<int>(base)));
    EXPECT_THAT(RefusalOf(points, {.base = base}), HasSubstr(why));
  }
}

// By a few times the noise at most: what is too long or too short looks like a tip or a hole.
TEST(ChooseClosedBaseTest, RoundEndsAreSmoothPolesWhereTheyAre) {
  for (const TurnedShape& shape : {WholeSphere(), Egg()}) {
    constexpr int kParts = 1000;
    double length = 0;
    for (int i = 0; i < kParts; ++i) {
      length += shape.TangentAt((i + 0.5) / kParts * shape.length).norm() * shape.length / kParts;
    }
    for (const unsigned seed : {1, 2, 3, 10}) {
      SCOPED_TRACE(shape.name + ", seed " + std::to_string(seed));
      const Parameterization base = Choose(Noisy(shape, 8000, seed)).base;
      EXPECT_EQ(base.poles.start, PoleKind::kSmooth);
      EXPECT_EQ(base.poles.end, PoleKind::kSmooth);
      // Along its last tangent a round end is a little shorter than round it.
      EXPECT_NEAR(base.length_v, length, 3 * 1e-3 * shape.Size());
    }
  }
}

TEST(ChooseClosedBaseTest, ClosesTheDirectionsAskedFor) {
  using Pair = std::pair<bool, bool>;
  const Eigen::Matrix3Xd torus = Noisy(TorusShapeOf()), pipe = Noisy(CylinderShapeOf());
  for (const auto& [closed, expected] : {std::pair{Closing::kNone, Pair{false, false}},
                                         std::pair{Closing::kU, Pair{true, false}},
                                         std::pair{Closing::kV, Pair{false, true}},
                                         std::pair{Closing::kBoth, Pair{true, true}}}) {
    SCOPED_TRACE(static_cast<int>(closed));
    const ParameterizationChoice choice = Choose(torus, {.closed = closed});
    EXPECT_EQ(choice.base.name, "torus");
    EXPECT_EQ((Pair{choice.base.periodic_u, choice.base.periodic_v}), expected);
    if (!expected.second) {
      const ParameterizationChoice round = Choose(pipe, {.closed = closed});
      EXPECT_EQ(round.base.name, "revolution");
      EXPECT_EQ(round.base.periodic_u, expected.first);
    } else {
      EXPECT_THAT(RefusalOf(pipe, {.closed = closed}),
                  HasSubstr("do not close in the direction asked for"));
    }
  }
}

TEST(ChooseClosedBaseTest, SaysThatOpenOnesDoNotClose) {
  for (const Closing closed : {Closing::kU, Closing::kV, Closing::kBoth}) {
    SCOPED_TRACE(static_cast<int>(closed));
    for (const BentSheet& sheet : {FlatSheet(2, 1), Roll(), ShellSheet()}) {
      SCOPED_TRACE(sheet.name);
      EXPECT_THAT(RefusalOf(Noisy(sheet), {.closed = closed}),
                  AnyOf(HasSubstr("do not close"), HasSubstr("nor are the points")));
    }
  }
}

// As a shape is turned, moved, and measured in other units.
TEST(ChooseClosedBaseTest, ChoosesTheSameInEveryUnitAndPlace) {
  for (const Kind& kind : Kinds()) {
    if (!kind.closed_u) continue;
    SCOPED_TRACE(kind.name);
    const ParameterizationChoice one = Choose(kind.points);
    for (const double unit : {1e-6, 1e6}) {
      SCOPED_TRACE(unit);
      const ParameterizationChoice other =
          Choose(unit * (kind.points.colwise() + Eigen::Vector3d(30, -50, 2)));
      EXPECT_EQ(other.base.name, one.base.name);
      EXPECT_EQ(other.base.periodic_u, one.base.periodic_u);
      EXPECT_EQ(other.base.periodic_v, one.base.periodic_v);
      EXPECT_EQ(other.base.poles.start, one.base.poles.start);
      EXPECT_EQ(other.base.poles.end, one.base.poles.end);
      EXPECT_NEAR(other.base.length_u, unit * one.base.length_u, 0.02 * unit * one.base.length_u);
      EXPECT_NEAR(other.base.length_v, unit * one.base.length_v, 0.02 * unit * one.base.length_v);
    }
  }
}

TEST(ChooseClosedBaseTest, GivesTheSameBitsForEveryNumberOfThreads) {
  for (const Kind& kind : Kinds()) {
    if (!kind.closed_u) continue;
    SCOPED_TRACE(kind.name);
    const ParameterizationChoice one = Choose(kind.points, {}, 1),
                                 three = Choose(kind.points, {}, 3);
    EXPECT_EQ(one.base.parameters, three.base.parameters);
    EXPECT_EQ(one.base.why, three.base.why);
    EXPECT_EQ(one.base.poles, three.base.poles);
  }
}

}  // namespace batten::internal::choose_closed_base_test
