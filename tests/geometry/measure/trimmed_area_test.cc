// SPDX-License-Identifier: MIT
// Areas of trimmed surfaces against formulas, and as sums of their pieces'.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "batten/geometry/make_surface.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/split.h"
#include "batten/geometry/surface_area.h"
#include "tolerances.h"
#include "trim_cases.h"
#include "angles.h"

namespace batten::internal::trimmed_area_test {

NurbsSurface Plane(double a, double b) {
  return MakeBilinear({0, 0, 0}, {a, 0, 0}, {0, b, 0}, {a, b, 0});
}

TEST(TrimmedAreaTest, OfPlanePartsIsTheirFormula) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    SCOPED_TRACE("scale " + std::to_string(scale));
    const NurbsSurface plane = Plane(3 * scale, 2 * scale);
    const double whole = 6 * scale * scale;
    const auto share = [&](std::vector<NurbsCurve<2>> loops) {
      return Area(Trimmed(plane, std::move(loops))) / whole;
    };
    EXPECT_NEAR(share({Circle({0.5, 0.5}, 0.4)}), 0.16 * kPi, kIterated);
    EXPECT_NEAR(share({Circle({0.5, 0.5}, 0.5)}), 0.25 * kPi, kIterated);
    EXPECT_NEAR(share({Circle({0.5, 0.5}, 0.4), Circle({0.6, 0.5}, 0.1)}), 0.15 * kPi, kIterated);
    EXPECT_NEAR(
        share({RectangleLoop(0, 1, 0, 1), RectangleLoop(0.2, 0.7, 0.1, 0.4)}), 0.85, kRounding);
    EXPECT_NEAR(share({RectangleLoop(0, 1, 0, 1)}), 1, kRounding);
    EXPECT_NEAR(Area(Trimmed(plane, {"", LoopsOfThreeRegions(), true})) / whole,
                (0.2 * 0.2 - 0.1 * 0.1 + 0.28 * 0.28 - 0.18 * 0.18) * kPi + 0.14 * 0.08,
                kIterated);
    EXPECT_NEAR(share({Ellipse({0.3, 0.6}, {1e-4, 1e-5})}) / (1e-9 * kPi), 1, kIterated);
  }
}

TEST(TrimmedAreaTest, OfASphereZoneAndACapIsTheirFormula) {
  const NurbsSurface sphere = MakeSphere({}, 2);  // v from pole to pole
  const auto height = [&](double v) { return sphere.At(0, v)[2]; };
  const double zone = 2 * kPi * 2 * (height(0.7) - height(0.4));
  EXPECT_NEAR(Area(Trimmed(sphere, {RectangleLoop(0, 1, 0.4, 0.7)})) / zone, 1, kIterated);
  EXPECT_NEAR(
      Area(Trimmed(sphere, {RectangleLoop(0.25, 0.5, 0.4, 0.7)})) / (zone / 4), 1, kIterated);
  const double cap = 2 * kPi * 2 * (2 - height(0.8));
  EXPECT_NEAR(Area(Trimmed(sphere, {RectangleLoop(0, 1, 0.8, 1)})) / cap, 1, kIterated);
}

// On a cylinder area is that of the parameters, where the angle is the integral of its derivative.
TEST(TrimmedAreaTest, OfADiscOnACylinderIsTheIntegralOfItsHeights) {
  const NurbsSurface cylinder = MakeCylinder({}, 1.5, {0, 2});
  for (const double radius : {0.05, 0.2, 0.4}) {
    SCOPED_TRACE("radius " + std::to_string(radius));
    const Eigen::Vector2d centre(0.45, 0.5);
    const auto angle = [&](double u) {
      const Eigen::Vector3d p = cylinder.At(u, 0);
      const double a = std::atan2(p[1], p[0]);
      return a < 0 ? a + 2 * kPi : a;
    };
    // ∫ (width of the disc in angle) dv, v = 1/2 + r sin φ: periodic in φ, so the trapezoidal rule
    // converges as fast as any.
    double sum = 0;
    constexpr int kCount = 200000;
    for (int k = 0; k < kCount; ++k) {
      const double phi = kPi * (k + 0.5) / kCount - kPi / 2, x = radius * std::cos(phi);
      sum += (angle(centre[0] + x) - angle(centre[0] - x)) * x * kPi / kCount;
    }
    const double expected = 1.5 * 2 * sum;
    EXPECT_NEAR(Area(Trimmed(cylinder, {Circle(centre, radius)})) / expected, 1, kIterated);
  }
}

NurbsSurface Sheet(RandomSplines& random) {
  const SplineBasis u = SplineBasis::Uniform(2, 6, -1, 5), v = SplineBasis::Uniform(3, 7, 10, 11);
  Eigen::Matrix3Xd points(3, u.size() * v.size());
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      points.col(i * v.size() + j) << u.Greville(i), v.Greville(j), random.Real(-0.5, 0.5);
    }
  }
  return NurbsSurface(u, v, points, random.Weights(points.cols(), 0.7, 1.4));
}

TEST(TrimmedAreaTest, PartAndRestMakeUpTheWhole) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    RandomSplines random(seed);
    const NurbsSurface sheet = Sheet(random);
    const double whole = Area(sheet);
    for (const LoopCase& loops : LoopCases(seed)) {
      if (loops.loops.size() > 1) continue;
      SCOPED_TRACE(loops.name + ", seed " + std::to_string(seed));
      const NurbsSurface part = Trimmed(sheet, loops);
      const NurbsSurface rest = Trimmed(sheet, {RectangleLoop(0, 1, 0, 1), loops.loops[0]});
      EXPECT_NEAR((Area(part) + Area(rest)) / whole, 1, kIterated);
    }
  }
}

TEST(TrimmedAreaTest, IsTheSumOverPiecesAndRectanglesAndTheSameInOtherParameters) {
  for (const LoopCase& loops : LoopCases(4)) {
    SCOPED_TRACE(loops.name);
    RandomSplines random(4);
    const NurbsSurface surface = Trimmed(Sheet(random), loops);
    const double whole = Area(surface);
    double pieces = 0;
    for (const NurbsSurface& piece : Decompose(surface)) pieces += Area(piece);
    EXPECT_NEAR(pieces / whole, 1, kIterated);
    double rectangles = 0;
    for (const auto& [a, b] : {std::pair(-1.0, 0.3), std::pair(0.3, 3.0), std::pair(3.0, 5.0)}) {
      for (const auto& [c, d] : {std::pair(10.0, 10.4), std::pair(10.4, 11.0)}) {
        rectangles += Area(surface, a, b, c, d);
      }
    }
    EXPECT_NEAR(rectangles / whole, 1, kIterated);
    EXPECT_NEAR(Area(Swapped(surface)) / whole, 1, kIterated);
    EXPECT_NEAR(Area(Reversed(surface, Direction::kU)) / whole, 1, kIterated);
  }
}

}  // namespace batten::internal::trimmed_area_test
