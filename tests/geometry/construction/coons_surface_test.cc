// SPDX-License-Identifier: MIT
#include "batten/geometry/coons_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/geometry/closure.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/reverse.h"
#include "construction_cases.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::coons_surface_test {

using ::testing::HasSubstr;
using Curves = std::vector<NurbsCurve<3>>;

const Eigen::Vector3d kCorner[4] = {{0, 0, 0}, {5, 0, 1}, {5, 4, 0}, {0, 4, 2}};

Curves RandomSides(RandomSplines& random, bool rational) {
  Curves sides;
  for (int k = 0; k < 4; ++k) {
    sides.push_back(NearSegment(random,
                                kCorner[k],
                                kCorner[(k + 1) % 4],
                                0.5,
                                random.Integer(1, 4),
                                rational && random.Coin()));
  }
  return sides;
}

// How far points of the four edges are from the sides.
double WorstEdge(const NurbsSurface& surface, const Curves& sides) {
  double worst = 0;
  const std::array<NurbsCurve<3>, 4> edges = BoundaryCurves(surface);  // u = 0, u = 1, v = 0, v = 1
  const int side_of[4] = {3, 1, 0, 2};
  for (int e = 0; e < 4; ++e) worst = std::max(worst, FarthestFrom(sides[side_of[e]], edges[e]));
  return worst;
}

TEST(CoonsTest, ContainsItsSides) {
  for (int seed = 0; seed < 24; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Curves sides = RandomSides(random, seed % 2 == 1);
    for (const bool bicubic : {false, true}) {
      const CoonsSurface coons = Coons(sides, {.tolerance = 1e-6, .bicubic = bicubic});
      EXPECT_LE(WorstEdge(coons.surface, sides), coons.error + 100 * kRounding);
      EXPECT_LE(coons.error, 1e-6);
      EXPECT_EQ(coons.gap, 0);
    }
  }
}

TEST(CoonsTest, PolynomialSidesAreMetPointByPoint) {
  RandomSplines random(3);
  const Curves sides = RandomSides(random, false);
  const NurbsSurface s = Coons(sides, {.tolerance = 1e-6}).surface;
  EXPECT_LE(DistanceAlong(
                s,
                [](double t) { return Eigen::Vector2d(t, 0); },
                [&](double t) { return AtShare(sides[0], t); }),
            100 * kRounding);
  EXPECT_LE(DistanceAlong(
                s,
                [](double t) { return Eigen::Vector2d(1, t); },
                [&](double t) { return AtShare(sides[1], t); }),
            100 * kRounding);
  EXPECT_LE(DistanceAlong(
                s,
                [](double t) { return Eigen::Vector2d(1 - t, 1); },
                [&](double t) { return AtShare(sides[2], t); }),
            100 * kRounding);
  EXPECT_LE(DistanceAlong(
                s,
                [](double t) { return Eigen::Vector2d(0, 1 - t); },
                [&](double t) { return AtShare(sides[3], t); }),
            100 * kRounding);
}

TEST(CoonsTest, OrderAndDirectionOfTheSidesDoNotMatter) {
  RandomSplines random(5);
  const Curves sides = RandomSides(random, false);
  const NurbsSurface plain = Coons(sides, {.tolerance = 1e-6}).surface;
  const Curves mixed = {sides[0], Reversed(sides[3]), sides[2], Reversed(sides[1])};
  EXPECT_LE(LargestDifference(plain, Coons(mixed, {.tolerance = 1e-6}).surface), 100 * kRounding);
}

TEST(CoonsTest, IsAffinelyInvariant) {
  for (int seed = 0; seed < 20; ++seed) {
    RandomSplines random(seed);
    Curves sides = RandomSides(random, seed % 2 == 1);
    for (const bool bicubic : {false, true}) {
      const CoonsSurface plain = Coons(sides, {.tolerance = 1e-4, .bicubic = bicubic});
      Curves mapped;
      for (const NurbsCurve<3>& side : sides) mapped.push_back(Transformed(side, SkewMap()));
      const CoonsSurface image = Coons(mapped, {.tolerance = 1e-4, .bicubic = bicubic});
      const double slack = plain.error > 0 ? 1e-2 : 1e4 * kRounding;
      EXPECT_LE(LargestDifference(Transformed(plain.surface, SkewMap()), image.surface), slack);
    }
  }
}

TEST(CoonsTest, ArcsOfACylinderGiveTheCylinder) {
  const NurbsSurface cylinder = MakeCylinder(Frame(), 2, {0, 3}, {0, 1.2});
  const auto edges = BoundaryCurves(cylinder);
  const CoonsSurface coons = Coons({edges[2], edges[1], edges[3], edges[0]}, {.tolerance = 1e-6});
  EXPECT_EQ(coons.error, 0);
  EXPECT_LE(LargestDifference(coons.surface, cylinder), 100 * kRounding);
}

TEST(CoonsTest, ThreeSidesEndInAPole) {
  const Curves sides = {MakeArc(Frame(), 1, {0, kPi / 2}),
                        MakeArc(Frame({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), 1, {0, kPi / 2}),
                        MakeArc(Frame({0, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1, {0, kPi / 2})};
  for (const bool bicubic : {false, true}) {
    const CoonsSurface coons = Coons(sides, {.tolerance = 1e-6, .bicubic = bicubic});
    EXPECT_EQ(CollapsedEdges(coons.surface), (CollapsedEdgeSet{.v_upper = true}));
    for (int k = 0; k <= 20; ++k) {
      const double t = k / 20.0;
      for (const Eigen::Vector3d& p :
           {coons.surface.At(t, 0), coons.surface.At(1, t), coons.surface.At(0, t)}) {
        EXPECT_NEAR(p.norm(), 1, 1e-6);
      }
    }
    EXPECT_LE((coons.surface.At(0.4, 1) - Eigen::Vector3d(0, 0, 1)).norm(), kIterated);
  }
}

TEST(CoonsTest, BicubicMeetsGivenDerivativesAcross) {
  RandomSplines random(9);
  Eigen::Matrix3Xd points(3, 16);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j)
      points.col(4 * i + j) = Eigen::Vector3d(i, j, 0) + random.Vector(0.3);
  }
  const SplineBasis cubic = SplineBasis::Uniform(3, 4, 0, 1);
  const NurbsSurface patch(cubic, cubic, points);
  const auto edges = BoundaryCurves(patch);
  const auto across = [&](bool in_v, int end) {
    Eigen::Matrix3Xd vectors(3, 4);
    for (int i = 0; i < 4; ++i) {
      const int a = end == 0 ? 0 : 2;
      vectors.col(i) = in_v ? 3 * (patch.control_point(i, a + 1) - patch.control_point(i, a))
                            : 3 * (patch.control_point(a + 1, i) - patch.control_point(a, i));
    }
    return NurbsCurve<3>(cubic, vectors);
  };
  CoonsOptions options{.tolerance = 1e-6, .bicubic = true};
  options.across = {{across(true, 0), across(true, 1), across(false, 0), across(false, 1)}};
  const Curves sides = {edges[2], edges[1], edges[3], edges[0]};
  // A bicubic patch is the blend of its own boundary data.
  EXPECT_LE(LargestDifference(Coons(sides, options).surface, patch), 100 * kRounding);
  Eigen::Matrix3Xd bad = (*options.across)[0].control_points();
  bad.col(1) += Eigen::Vector3d(0, 0, 0.1);
  (*options.across)[0] = NurbsCurve<3>(cubic, bad);
  EXPECT_THAT(RefusalOf([&] { Coons(sides, options); }), HasSubstr("twists"));
  bad.col(0) += Eigen::Vector3d(0, 0, 0.1);
  (*options.across)[0] = NurbsCurve<3>(cubic, bad);
  EXPECT_THAT(RefusalOf([&] { Coons(sides, options); }), HasSubstr("differ by 0.1"));
}

TEST(CoonsTest, Refusals) {
  RandomSplines random(1);
  Curves sides = RandomSides(random, false);
  EXPECT_THAT(RefusalOf([&] {
                Coons({sides[0], sides[1]}, {.tolerance = 1e-6});
              }),
              HasSubstr("three or four"));
  sides[2] = Transformed(sides[2], Translation({0, 0, 0.25}));
  EXPECT_THAT(RefusalOf([&] { Coons(sides, {.tolerance = 1e-6}); }),
              HasSubstr("sides 2 and 3 do not meet: their nearest ends are 0.25 apart"));
  EXPECT_NEAR(Coons(sides, {.tolerance = 0.3}).gap, 0.25, kRounding);
  sides[2] = MakeArc(Frame(), 1);
  EXPECT_THAT(RefusalOf([&] { Coons(sides, {.tolerance = 1e-6}); }), HasSubstr("side 3 is closed"));
}

}  // namespace batten::internal::coons_surface_test
