// SPDX-License-Identifier: MIT
#include "batten/geometry/join.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/remove_knots.h"
#include "batten/geometry/split.h"
#include "law_cases.h"
#include "random_splines.h"
#include "same_shape.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::join_test {

// A tolerance for gaps that are rounding only.
constexpr double kGap = 1e-9;

TEST(JoinTest, UndoesSplitting) {
  const auto law = [](const auto& curve, RandomSplines& random) {
    const SplineBasis& basis = curve.basis();
    const double u = random.Real(basis.lower(), basis.upper());
    const auto [low, high] = Split(curve, u);
    const auto whole = Join(low, high, kGap);
    EXPECT_EQ(whole.basis().Multiplicity(u), basis.degree());
    EXPECT_EQ(whole.basis().lower(), basis.lower());
    EXPECT_NEAR(whole.basis().upper(), basis.upper(), 4 * kUnitRoundoff * DomainExtent(basis));
    // Shifted knots are rounded.
    const double units =
        64 * DomainExtent(basis) / ShortestSpan(whole.basis()) * WeightRatio(curve);
    for (int k = 0; k < kComparedPlaces; ++k) {
      const double t = random.Real(basis.lower(), basis.upper());
      EXPECT_LE((curve.At(t) - whole.At(t)).cwiseAbs().maxCoeff(),
                units * (basis.degree() + 1) * kUnitRoundoff);
    }
    const auto same = RemoveKnot(whole, u, basis.degree(), kGap);
    EXPECT_EQ(same.removed, basis.degree() - basis.Multiplicity(u));
  };
  ForRandomCurves<2>(law, 8);
  ForRandomCurves<3>(law, 8);
}

// The second curve moved to the end of the first; a different degree, knots and weights.
TEST(JoinTest, IsTheFirstCurveAndThenTheSecond) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const auto any = [&] {
      return random.Curve<3>(
          random.Integer(1, 8), random.Coin(), KindOfBasis(random.Integer(0, 2)));
    };
    const NurbsCurve<3> first = any(), loose = any();
    const Eigen::Vector3d shift = first.At(first.basis().upper()) - loose.At(loose.basis().lower());
    const NurbsCurve<3> second(
        loose.basis(), loose.control_points().colwise() + shift, loose.weights());
    const NurbsCurve<3> joined = Join(first, second, kGap);
    const double joint = first.basis().upper();
    EXPECT_EQ(joined.basis().degree(), std::max(first.basis().degree(), second.basis().degree()));
    EXPECT_EQ(joined.basis().Multiplicity(joint), joined.basis().degree());
    for (int k = 0; k < kComparedPlaces; ++k) {
      const double u = random.Parameter(first.basis()), v = random.Parameter(second.basis());
      EXPECT_LE((joined.At(u) - first.At(u)).norm(), kIterated);
      EXPECT_LE((joined.At(joint + (v - second.basis().lower())) - second.At(v)).norm(), kIterated);
    }
  }
}

TEST(JoinTest, ClosesAGapWithinTheToleranceInTheMiddle) {
  const NurbsCurve<2> first(SplineBasis(1, {0, 0, 1, 1}), Eigen::Matrix2d{{0, 1}, {0, 0}});
  const NurbsCurve<2> second(SplineBasis(1, {5, 5, 7, 7}), Eigen::Matrix2d{{1.25, 3}, {0, 0}});
  const NurbsCurve<2> joined = Join(first, second, 0.25);
  EXPECT_EQ(joined.control_points(), (Eigen::Matrix<double, 2, 3>{{0, 1.125, 3}, {0, 0, 0}}));
  EXPECT_EQ(joined.basis(), SplineBasis(1, {0, 0, 1, 3, 3}));
  EXPECT_EQ(
      RefusalOf([&] { Join(first, second, 0.2); }),
      "Join: the gap between the end of the first and the start of the second is 0.25, above the "
      "tolerance 0.2");
  EXPECT_EQ(RefusalOf([&] { Join(first, second, -1); }),
            "Join: tolerance = -1 is not a number of at least 0");
}

TEST(JoinTest, UndoesSplittingOfSurfaces) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    for (const Direction direction : {Direction::kU, Direction::kV}) {
      const SplineBasis& basis = direction == Direction::kU ? surface.basis_u() : surface.basis_v();
      const double at = random.Real(basis.lower(), basis.upper());
      const auto [low, high] = Split(surface, direction, at);
      const NurbsSurface whole = Join(low, high, direction, kGap);
      EXPECT_EQ(direction == Direction::kU ? whole.basis_v() : whole.basis_u(),
                direction == Direction::kU ? surface.basis_v() : surface.basis_u());
      for (int k = 0; k < kComparedPlaces; ++k) {
        const double u = random.Parameter(surface.basis_u()),
                     v = random.Parameter(surface.basis_v());
        const double w = direction == Direction::kU ? u : v;
        if (std::abs(w - at) <= kGap || w == basis.upper()) continue;
        EXPECT_LE((surface.At(u, v) - whole.At(u, v)).norm(), kIterated);
      }
    }
  });
}

// The pieces made different across: raised, refined, over another domain.
TEST(JoinTest, MakesSurfacesAgreeAcrossTheEdge) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = random.Surface(random.Integer(1, 4),
                                                random.Integer(1, 4),
                                                random.Coin(),
                                                {},
                                                KindOfBasis(random.Integer(0, 2)));
    const auto [low, loose] = Split(
        surface, Direction::kU, random.Real(surface.basis_u().lower(), surface.basis_u().upper()));
    const SplineBasis& v = surface.basis_v();
    NurbsSurface high = Elevated(loose, Direction::kV, random.Integer(0, 2));
    high = Elevated(high, Direction::kU, random.Integer(0, 2));
    const double extra = random.Real(v.lower(), v.upper());
    if (high.basis_v().Multiplicity(extra) == 0) high = InsertKnot(high, Direction::kV, extra);
    high = NurbsSurface(
        high.basis_u(), Scaled(high.basis_v(), -1, 2), high.control_points(), 3 * high.weights());
    const NurbsSurface whole = Join(low, high, Direction::kU, kGap);
    for (int k = 0; k < kComparedPlaces; ++k) {
      const double s = random.Real(surface.basis_u().lower(), surface.basis_u().upper()),
                   t = random.Parameter(v);
      EXPECT_LE((surface.At(s, t) - whole.At(s, t)).norm(), kIterated);
    }
  }
}

TEST(JoinTest, RefusesSurfacesThatDoNotMeet) {
  const NurbsSurface flat(SplineBasis(1, {0, 0, 1, 1}),
                          SplineBasis(1, {0, 0, 1, 1}),
                          Eigen::Matrix<double, 3, 4>{{0, 0, 1, 1}, {0, 1, 0, 1}, {0, 0, 0, 0}});
  EXPECT_NE(RefusalOf([&] { Join(flat, flat, Direction::kU, 0.5); }), "accepted");
  const NurbsSurface next = flat.Translated({1, 0, 0});
  EXPECT_EQ(Join(flat, next, Direction::kU, 0).size_u(), 3);
  EXPECT_NE(RefusalOf([&] { Join(flat, next, Direction::kV, 0.5); }), "accepted");
}

}  // namespace batten::internal::join_test
