// SPDX-License-Identifier: MIT
#include "fitting/outline/four_sided_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "batten/geometry/knot_vectors.h"

namespace batten::internal::four_sided_map_test {

// A side from a to b that swings out by `swing` on its left.
NurbsCurve<2> Bow(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double swing) {
  const Eigen::Vector2d along = b - a, left(-along[1], along[0]);
  Eigen::Matrix2Xd points(2, 4);
  points << a, a + along / 3 + swing * left, b - along / 3 + swing * left, b;
  return NurbsCurve<2>(SplineBasis::Uniform(3, 4, 2, 5), points);
}

PlaneSides Quadrilateral(std::mt19937_64& engine, double most_swing) {
  std::uniform_real_distribution<double> wobble(-0.3, 0.3), swing(-most_swing, most_swing);
  const Eigen::Vector2d a(wobble(engine), wobble(engine)), b(4 + wobble(engine), wobble(engine)),
      c(4 + wobble(engine), 3 + wobble(engine)), d(wobble(engine), 3 + wobble(engine));
  return {Bow(a, b, swing(engine)),
          Bow(d, c, swing(engine)),
          Bow(a, d, swing(engine)),
          Bow(b, c, swing(engine))};
}

constexpr double kRounding = 1e-12;  // some hundred operations on numbers below ten

TEST(FourSidedMapTest, EndsInTheSides) {
  std::mt19937_64 engine(1);
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE(round);
    const PlaneSides sides = Quadrilateral(engine, 0.2);
    const FourSidedMap map(sides);
    for (double t = 0; t <= 1; t += 0.125) {
      const double at = 2 + 3 * t;
      EXPECT_LT((map.At(t, 0).point - sides.lower_v.At(at)).norm(), kRounding);
      EXPECT_LT((map.At(t, 1).point - sides.upper_v.At(at)).norm(), kRounding);
      EXPECT_LT((map.At(0, t).point - sides.lower_u.At(at)).norm(), kRounding);
      EXPECT_LT((map.At(1, t).point - sides.upper_u.At(at)).norm(), kRounding);
    }
  }
}

TEST(FourSidedMapTest, InvertsItselfInsideAndALittleBeyond) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> place(-0.05, 1.05);
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE(round);
    const FourSidedMap map(Quadrilateral(engine, 0.2));
    ASSERT_TRUE(map.one_to_one());
    for (int k = 0; k < 50; ++k) {
      const Eigen::Vector2d at(place(engine), place(engine));
      const auto found = map.Invert(map.At(at[0], at[1]).point);
      ASSERT_TRUE(found);
      EXPECT_LT((*found - at).norm(), 1e-10) << "Newton's last step is below 1e-13";
    }
  }
}

TEST(FourSidedMapTest, DerivativesAreThoseOfThePoint) {
  std::mt19937_64 engine(3);
  const FourSidedMap map(Quadrilateral(engine, 0.2));
  constexpr double kStep = 1e-6, kOff = 1e-8;  // rounding over the step, third derivatives by step²
  for (double s = 0.1; s < 1; s += 0.2) {
    for (double t = 0.15; t < 1; t += 0.2) {
      const auto jet = map.At(s, t);
      const Eigen::Vector2d ds = (map.At(s + kStep, t).point - map.At(s - kStep, t).point),
                            dt = (map.At(s, t + kStep).point - map.At(s, t - kStep).point);
      EXPECT_LT((ds / (2 * kStep) - jet.ds).norm(), kOff);
      EXPECT_LT((dt / (2 * kStep) - jet.dt).norm(), kOff);
    }
  }
}

TEST(FourSidedMapTest, TellsAFold) {
  const Eigen::Vector2d a(0, 0), b(4, 0), c(4, 3), d(0, 3);
  EXPECT_TRUE(
      FourSidedMap({Bow(a, b, 0.1), Bow(d, c, 0.1), Bow(a, d, 0), Bow(b, c, 0)}).one_to_one());
  EXPECT_FALSE(
      FourSidedMap({Bow(a, b, 1.2), Bow(d, c, -1.2), Bow(a, d, 0), Bow(b, c, 0)}).one_to_one())
      << "the lower side rises above the upper one";
  EXPECT_FALSE(FourSidedMap({Bow(a, b, 0), Bow(c, d, 0), Bow(a, c, 0), Bow(b, d, 0)}).one_to_one())
      << "crossed";
}

TEST(FourSidedMapTest, MovesSidesToTheCornerThatIsHeld) {
  const Eigen::Vector2d a(0, 0), b(4, 0), c(4, 3), d(0, 3), off(0.01, 0.02);
  PlaneSides sides{Bow(a, b, 0), Bow(d, c, 0), Bow(a + off, d, 0), Bow(b, c, 0)};
  EXPECT_LT((FourSidedMap(sides).At(0, 0).point - (a + off / 2)).norm(), kRounding);
  sides.held = {true, false, false, false};
  EXPECT_LT((FourSidedMap(sides).At(0, 0).point - a).norm(), kRounding);
  sides.held = {false, false, true, false};
  EXPECT_LT((FourSidedMap(sides).At(0, 0).point - (a + off)).norm(), kRounding);
}

}  // namespace batten::internal::four_sided_map_test
