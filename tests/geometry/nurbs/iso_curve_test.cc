// SPDX-License-Identifier: MIT
#include "batten/geometry/iso_curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "exact_shapes.h"
#include "fixtures.h"
#include "law_cases.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::iso_curve_test {

using fixtures::Json;

TEST(IsoCurveTest, RunsOnTheSurface) {
  ForRandomSurfaces([](const NurbsSurface& unit, RandomSplines& random) {
    for (const double scale : kCoordinateScales) {
      const NurbsSurface surface = Enlarged(unit, scale);
      const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
      // The header's bound for control points, and the same for the evaluations.
      const double bound = 16 * (bu.degree() + bv.degree()) * kUnitRoundoff * scale;
      const double a = random.Parameter(bu), b = random.Parameter(bv);
      const NurbsCurve<3> along_v = IsoCurve(surface, Direction::kU, a);
      const NurbsCurve<3> along_u = IsoCurve(surface, Direction::kV, b);
      EXPECT_EQ(along_v.basis(), bv);
      EXPECT_EQ(along_u.basis(), bu);
      if (!surface.rational()) {
        EXPECT_FALSE(along_v.rational());
        EXPECT_FALSE(along_u.rational());
      }
      for (int trial = 0; trial < 5; ++trial) {
        const double u = random.Parameter(bu), v = random.Parameter(bv);
        EXPECT_LE((along_v.At(v) - surface.At(a, v)).norm(), bound);
        EXPECT_LE((along_u.At(u) - surface.At(u, b)).norm(), bound);
      }
    }
  });
}

// The weight function of the curve is that of the surface, so that derivatives agree too.
TEST(IsoCurveTest, HasThePartialDerivativesOfTheSurface) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const double a = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
    const auto got = IsoCurve(surface, Direction::kU, a).Derivatives(v, 2);
    const SurfaceDerivatives expected = surface.Derivatives(a, v, 2);
    for (int k = 0; k <= 2; ++k) {
      const double size = std::max(got.col(k).norm(), 1.0);
      EXPECT_LE((got.col(k) - expected(0, k)).norm(), kHalfDigits * size) << "order " << k;
    }
  });
}

TEST(IsoCurveTest, BoundaryCurvesAreTheEdges) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
    const auto [low_u, high_u, low_v, high_v] = BoundaryCurves(surface);
    const double bound = 16 * (bu.degree() + bv.degree()) * kUnitRoundoff;
    const double u = random.Parameter(bu), v = random.Parameter(bv);
    EXPECT_LE((low_u.At(v) - surface.At(bu.lower(), v)).norm(), bound);
    EXPECT_LE((high_u.At(v) - surface.At(bu.upper(), v)).norm(), bound);
    EXPECT_LE((low_v.At(u) - surface.At(u, bv.lower())).norm(), bound);
    EXPECT_LE((high_v.At(u) - surface.At(u, bv.upper())).norm(), bound);
  });
}

TEST(IsoCurveTest, EdgesOfAClampedNetAreItsOuterRowsBitByBit) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    const NurbsSurface s =
        random.Surface(random.Integer(1, 8), random.Integer(1, 8), seed % 2 == 1);
    const int n = s.size_u(), m = s.size_v();
    const auto [low_u, high_u, low_v, high_v] = BoundaryCurves(s);
    for (int j = 0; j < m; ++j) {
      EXPECT_EQ(low_u.control_points().col(j), s.control_point(0, j));
      EXPECT_EQ(high_u.control_points().col(j), s.control_point(n - 1, j));
      EXPECT_EQ(low_u.weights()[j], s.weights()[j]);
      EXPECT_EQ(high_u.weights()[j], s.weights()[(n - 1) * m + j]);
    }
    for (int i = 0; i < n; ++i) {
      EXPECT_EQ(low_v.control_points().col(i), s.control_point(i, 0));
      EXPECT_EQ(high_v.control_points().col(i), s.control_point(i, m - 1));
      EXPECT_EQ(low_v.weights()[i], s.weights()[i * m]);
      EXPECT_EQ(high_v.weights()[i], s.weights()[i * m + m - 1]);
    }
  }
}

TEST(IsoCurveTest, ACollapsedEdgeIsACurveInOnePoint) {
  const NurbsSurface sphere = Sphere(2);
  const auto [low_u, high_u, low_v, high_v] = BoundaryCurves(sphere);
  EXPECT_LE((high_v.control_points().colwise() - Eigen::Vector3d(0, 0, 2)).norm(), kRounding);
  EXPECT_LE((low_v.control_points().colwise() - Eigen::Vector3d(0, 0, -2)).norm(), kRounding);
  EXPECT_LE((low_u.control_points() - high_u.control_points()).norm(), kRounding);
}

TEST(IsoCurveTest, WrapsInAPeriodicDirectionAndRefusesOutsideOtherwise) {
  RandomSplines random(5);
  const NurbsSurface surface = random.Surface(3, 2, true, KindOfBasis(2), KindOfBasis(0));
  const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
  const double u = bu.lower() + 0.3 * (bu.upper() - bu.lower());
  const NurbsCurve<3> once = IsoCurve(surface, Direction::kU, u);
  const NurbsCurve<3> again = IsoCurve(surface, Direction::kU, u + bu.upper() - bu.lower());
  EXPECT_LE((once.control_points() - again.control_points()).norm(), kRounding);
  EXPECT_THAT(RefusalOf([&] { IsoCurve(surface, Direction::kV, bv.upper() + 1); }),
              testing::HasSubstr("IsoCurve: v = "));
  EXPECT_THAT(RefusalOf([&] { IsoCurve(surface, Direction::kU, NAN); }),
              testing::HasSubstr("is outside the domain"));
  EXPECT_THAT(RefusalOf([&] { IsoCurve(surface, Direction::kU, INFINITY); }),
              testing::HasSubstr("IsoCurve: u = inf is outside the domain ["));
}

TEST(IsoCurveTest, PassesThroughTheOraclePointsOfSurfaces) {
  fixtures::CheckAll(
      "surface_eval.json", [](const Json& input, const Json& expected, double tolerance) {
        const NurbsSurface surface = fixtures::Surface(input.at("surface"));
        const double u = input.at("u"), v = input.at("v");
        const Json& at =
            expected.contains("point") ? expected.at("point") : expected.at("derivs").at(0).at(0);
        const Eigen::Vector3d point = fixtures::Vector(at);
        fixtures::ExpectClose(IsoCurve(surface, Direction::kU, u).At(v), point, tolerance);
        fixtures::ExpectClose(IsoCurve(surface, Direction::kV, v).At(u), point, tolerance);
      });
}

}  // namespace batten::internal::iso_curve_test
