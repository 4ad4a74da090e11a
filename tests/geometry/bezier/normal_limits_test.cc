// SPDX-License-Identifier: MIT
#include "geometry/bezier/normal_limits.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "exact_shapes.h"
#include "fixtures.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::normal_limits_test {

NurbsSurface WithPoints(const NurbsSurface& surface, const Eigen::Matrix3Xd& points) {
  return NurbsSurface(surface.basis_u(), surface.basis_v(), points, surface.weights());
}

NurbsSurface Swapped(const NurbsSurface& surface) {
  const int n = surface.size_u(), m = surface.size_v();
  Eigen::Matrix3Xd points(3, n * m);
  Eigen::VectorXd weights(n * m);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      points.col(j * n + i) = surface.control_point(i, j);
      weights[j * n + i] = surface.weights()[i * m + j];
    }
  }
  return NurbsSurface(surface.basis_v(), surface.basis_u(), points, weights);
}

// The first or last `rows` rows of the net in v drawn into one point.
NurbsSurface Collapsed(const NurbsSurface& whole, bool last, int rows) {
  Eigen::Matrix3Xd points = whole.control_points();
  const int m = whole.size_v();
  for (int i = 0; i < whole.size_u(); ++i) {
    for (int r = 0; r < rows; ++r) {
      points.col(i * m + (last ? m - 1 - r : r)) = whole.control_point(0, last ? m - 1 : 0);
    }
  }
  return WithPoints(whole, points);
}

// A bilinear to biquadratic patch over [0,1]² from its net, rows of u.
NurbsSurface Patch(int p, int q, const Eigen::Matrix3Xd& points) {
  return NurbsSurface(
      SplineBasis::Uniform(p, p + 1, 0, 1), SplineBasis::Uniform(q, q + 1, 0, 1), points);
}

TEST(NormalLimitsTest, AtThePolesOfASphereIsTheAxis) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Eigen::Matrix3d turn = random.Orthogonal();
    const double hand = turn.determinant();
    const Eigen::Vector3d shift = random.Vector(1) * random.Logarithmic(1e-3, 1e6);
    for (const double scale : {1e-9, 1.0, 1e9}) {
      const NurbsSurface sphere = Sphere(scale);
      const NurbsSurface turned =
          WithPoints(sphere, (turn * sphere.control_points()).colwise() + scale * shift);
      const double u = random.Parameter(sphere.basis_u());
      for (const double v : {0.0, 1.0}) {
        const auto normal = turned.NormalAt(u, v);
        ASSERT_TRUE(normal);
        const Eigen::Vector3d expected = turn * Eigen::Vector3d(0, 0, hand * (v > 0 ? 1 : -1));
        EXPECT_NEAR((*normal - expected).norm(), 0, kRounding * (1 + shift.norm()));
        // A hair inside too.
        const auto inside = turned.NormalAt(u, v > 0 ? 1 - 1e-14 : 1e-14);
        ASSERT_TRUE(inside);
        EXPECT_NEAR((*inside - expected).norm(), 0, 0.05);
      }
    }
  }
}

TEST(NormalLimitsTest, AtThePoleOfASphereWithRoundedPolesIsTheAxis) {
  using namespace fixtures;
  int seen = 0;
  CheckAll("exact_primitives.json", [&](const Json& input, const Json& expected, double) {
    if (input.at("kind") != "sphere") return;
    ++seen;
    const NurbsSurface sphere = Surface(expected.at("one_valid_nurbs"));
    for (int k = 0; k <= 20; ++k) {
      const double u = sphere.basis_u().upper() * k / 20;
      for (const double v : {sphere.basis_v().lower(), sphere.basis_v().upper()}) {
        const auto normal = sphere.NormalAt(u, v);
        ASSERT_TRUE(normal);
        EXPECT_NEAR((*normal - Eigen::Vector3d(0, 0, v > 0 ? 1 : -1)).norm(), 0, kIterated);
      }
    }
  });
  EXPECT_EQ(seen, 2);
}

TEST(NormalLimitsTest, AtTheTipOfAConeEachRulingHasItsOwn) {
  const NurbsSurface cone = Cone(3, 4);
  for (const double u : {0.0, 0.1, 0.25, 0.4, 0.77, 1.0}) {
    const auto tip = cone.NormalAt(u, 0), side = cone.NormalAt(u, 0.5);
    ASSERT_TRUE(tip && side);
    EXPECT_NEAR((*tip - *side).norm(), 0, kRounding);
  }
}

TEST(NormalLimitsTest, OnACollapsedEdgeIsApproachedFromInside) {
  int seen = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = random.Integer(1, 5), q = random.Integer(1, 5);
    const bool last = random.Coin(), swap = random.Coin();
    const int rows = random.Integer(1, std::min(q, 3));
    const NurbsSurface surface =
        Collapsed(random.Surface(p, q, random.Coin(), {.most_spans = 3}), last, rows);
    const SplineBasis& bv = surface.basis_v();
    const double u = random.Parameter(surface.basis_u());
    const double span =
        last ? bv.upper() - bv.knots()[bv.size() - 1] : bv.knots()[q + 1] - bv.lower();
    const auto normal = [&](double v) {
      return swap ? Swapped(surface).NormalAt(v, u) : surface.NormalAt(u, v);
    };
    const auto at_edge = normal(last ? bv.upper() : bv.lower());
    ASSERT_TRUE(at_edge);
    // The distance from the limit falls with the distance from the edge.
    const auto off = [&](double part) {
      const auto near = normal(last ? bv.upper() - part * span : bv.lower() + part * span);
      return near ? (*near - *at_edge).norm() : 2.0;
    };
    EXPECT_LE(off(1e-6), 0.02 * off(1e-4) + kHalfDigits);
    EXPECT_LE(off(1e-7), 0.2 * off(1e-6) + kHalfDigits);
    seen += off(1e-4) > 0;
  }
  EXPECT_GT(seen, 100);
}

TEST(NormalLimitsTest, AtACornerOfCoincidentPointsOfAFlatPatchIsThePlanes) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = random.Integer(2, 4), q = random.Integer(2, 4);
    Eigen::Matrix3Xd points(3, (p + 1) * (q + 1));
    for (int i = 0; i <= p; ++i) {
      for (int j = 0; j <= q; ++j) points.col(i * (q + 1) + j) << i, j, 0;
    }
    points.col(q + 1) = points.col(0);  // P_10 = P_00
    if (random.Coin()) points.col(1) = points.col(0);
    const Eigen::Matrix3d turn = random.Orthogonal();
    const auto normal = Patch(p, q, turn * points).NormalAt(0, 0);
    ASSERT_TRUE(normal);
    EXPECT_NEAR((*normal - turn.determinant() * turn.col(2)).norm(), 0, kRounding);
  }
}

TEST(NormalLimitsTest, AtACornerOfParallelTangentsIsThePlanes) {
  // The corner (0,0) of this flat patch is a straight angle: S_u and S_v point apart.
  const Eigen::Matrix3Xd points{
      {0, -1, -1, 1, 0, -1, 1, 1, 0}, {0, 0, 1, 0, 1, 2, 1, 2, 3}, {0, 0, 0, 0, 0, 0, 0, 0, 0}};
  const NurbsSurface flat = Patch(2, 2, points);
  ASSERT_FALSE(UnitNormal(flat.JetAt(0, 0)));
  const auto normal = flat.NormalAt(0, 0);
  ASSERT_TRUE(normal);
  EXPECT_NEAR((*normal - Eigen::Vector3d::UnitZ()).norm(), 0, kRounding);
}

TEST(NormalLimitsTest, AtACornerThatDependsOnTheDirectionIsNone) {
  int none = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    RandomSplines random(seed);
    const NurbsSurface whole = random.Surface(3, 3, random.Coin(), {.most_spans = 1});
    Eigen::Matrix3Xd points = whole.control_points();
    points.col(4) = points.col(0);  // P_10 = P_00: S_u vanishes there
    none += !WithPoints(whole, points).NormalAt(whole.basis_u().lower(), whole.basis_v().lower());
  }
  EXPECT_EQ(none, 50);
}

TEST(NormalLimitsTest, OnAFoldIsNone) {
  // x = (u − 1/2)², y = v
  const NurbsSurface folded =
      Patch(2,
            1,
            Eigen::Matrix<double, 3, 6>{
                {0.25, 0.25, -0.25, -0.25, 0.25, 0.25}, {0, 1, 0, 1, 0, 1}, {0, 0, 0, 0, 0, 0}});
  EXPECT_FALSE(folded.NormalAt(0.5, 0.3));
  EXPECT_NEAR(folded.NormalAt(0.6, 0.3)->z(), 1, kRounding);
  EXPECT_NEAR(folded.NormalAt(0.4, 0.3)->z(), -1, kRounding);
}

TEST(NormalLimitsTest, OfALineOrAPointIsNone) {
  RandomSplines random(4);
  const NurbsSurface sheet = random.Sheet(3, 2, 0.5, {.most_spans = 2});
  Eigen::Matrix3Xd line = sheet.control_points();
  for (int i = 0; i < line.cols(); ++i) line.col(i) = line(0, i) * Eigen::Vector3d(1, 2, 3) / 7;
  for (const Eigen::Matrix3Xd& points : {line, Eigen::Matrix3Xd(0 * line)}) {
    const NurbsSurface surface = WithPoints(sheet, points);
    for (const double part : {0.0, 0.3, 1.0}) {
      const auto at = [&](const SplineBasis& b) {
        return b.lower() + part * (b.upper() - b.lower());
      };
      EXPECT_FALSE(surface.NormalAt(at(surface.basis_u()), at(surface.basis_v())));
    }
  }
}

TEST(NormalLimitsTest, AtACollapsedInnerKnotIsThatOfThePieceToTheRight) {
  // An hourglass: radius 1, 0, 2 at v = 0, 1/2, 1.
  const NurbsSurface hourglass = Revolved(SplineBasis(1, {0, 0, 0.5, 1, 1}),
                                          Eigen::Matrix<double, 2, 3>{{1, 0, 2}, {0, 1, 2}},
                                          Eigen::Vector3d::Ones());
  for (const double u : {0.0, 0.1, 0.6}) {
    const auto knot = hourglass.NormalAt(u, 0.5), above = hourglass.NormalAt(u, 0.7);
    ASSERT_TRUE(knot && above);
    EXPECT_NEAR((*knot - *above).norm(), 0, kRounding);
  }
}

TEST(NormalLimitsTest, WhereAPowerOfTheParametersStopsBothTangentsIsThatOfTheShape) {
  // (u³, v³, u³ v³) turns slow at (0,0), where its normal is z.
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 16);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) points.col(4 * i + j) << (i == 3), (j == 3), (i == 3 && j == 3);
  }
  const auto normal = Patch(3, 3, points).NormalAt(0, 0);
  ASSERT_TRUE(normal);
  EXPECT_NEAR((*normal - Eigen::Vector3d::UnitZ()).norm(), 0, kRounding);
}

TEST(NormalLimitsTest, WhereTheSurfaceIsRegularIsTheCrossProduct) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = random.Surface(
        random.Integer(1, 5), random.Integer(1, 5), random.Coin(), {.clamped = random.Coin()});
    const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
    const auto expected = UnitNormal(surface.JetAt(u, v)), slow = LimitNormal(surface, u, v);
    ASSERT_TRUE(expected && slow);
    const SurfaceJet jet = surface.JetAt(u, v);
    const double sine = jet.du.cross(jet.dv).norm() / (jet.du.norm() * jet.dv.norm());
    EXPECT_NEAR((*slow - *expected).norm(), 0, kRounding / sine);
    EXPECT_NEAR((*surface.NormalAt(u, v) - *expected).norm(), 0, kRounding / sine);
  }
}

TEST(NormalLimitsTest, ChangesSignWhenTheDirectionsAreSwapped) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface =
        Collapsed(random.Surface(3, 3, random.Coin(), {.most_spans = 2}), false, 1);
    const double u = random.Parameter(surface.basis_u()), v = surface.basis_v().lower();
    const auto normal = surface.NormalAt(u, v), other = Swapped(surface).NormalAt(v, u);
    ASSERT_TRUE(normal && other);
    EXPECT_NEAR((*normal + *other).norm(), 0, kIterated);
  }
}

}  // namespace batten::internal::normal_limits_test
