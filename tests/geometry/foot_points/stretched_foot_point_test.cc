// SPDX-License-Identifier: MIT
// Closest points of shapes a thousand to a million times as long as wide. The oracle is a planted
// place: a point at a known distance from one can't be farther than that.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "batten/geometry/foot_point.h"
#include "geometry/foot_points/hull_search.h"
#include "nasty_surfaces.h"
#include "random_splines.h"

namespace batten::internal::stretched_foot_point_test {

constexpr int kShapes = 60, kPoints = 12;

Eigen::Matrix3d RandomTurn(RandomSplines& random) {
  return Eigen::AngleAxisd(random.Real(0, 3), random.Vector(1).normalized()).toRotationMatrix();
}

// Stretched along an axis, and turned in half of the cases.
Eigen::Matrix3Xd Stretched(const Eigen::Matrix3Xd& points, double by, RandomSplines& random) {
  const Eigen::Matrix3Xd longer = Eigen::Vector3d(1, 1, by).asDiagonal() * points;
  if (random.Coin()) return longer;
  return RandomTurn(random) * longer;
}

double StretchOf(int seed) { return std::pow(10.0, 3 + seed % 4); }

NurbsSurface StretchedSurface(int seed, RandomSplines& random) {
  const NurbsSurface surface =
      random.Surface(random.Integer(1, 5), random.Integer(1, 5), random.Coin(), {.most_spans = 3});
  return WithPoints(surface, Stretched(surface.control_points(), StretchOf(seed), random));
}

NurbsCurve<3> StretchedCurve(int seed, RandomSplines& random) {
  const NurbsCurve<3> curve = random.Curve<3>(1 + seed * 7 % 25, random.Coin(), {.most_spans = 3});
  return NurbsCurve<3>(
      curve.basis(), Stretched(curve.control_points(), StretchOf(seed), random), curve.weights());
}

TEST(StretchedFootPointTest, SurfaceIsNoFartherThanAPlantedPlace) {
  for (int seed = 0; seed < kShapes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(static_cast<unsigned>(seed));
    const NurbsSurface surface = StretchedSurface(seed, random);
    const SurfaceFootPoints feet(surface);
    const double rounding = 1e-10 * StretchOf(seed);  // what a search may miss
    for (int k = 0; k < kPoints; ++k) {
      const Eigen::Vector3d place =
          surface.At(random.Parameter(surface.basis_u()), random.Parameter(surface.basis_v()));
      const Eigen::Vector3d off = random.Vector(std::pow(10.0, -k % 5));
      const SurfaceFoot foot = feet.Nearest(place + off);
      EXPECT_LE(foot.distance, off.norm() + rounding);
      EXPECT_LE(foot.lower_bound, off.norm() + rounding);
      EXPECT_TRUE(foot.certified) << foot.lower_bound << " of " << foot.distance;
    }
  }
}

TEST(StretchedFootPointTest, CurveIsNoFartherThanAPlantedPlace) {
  for (int seed = 0; seed < kShapes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(static_cast<unsigned>(seed));
    const NurbsCurve<3> curve = StretchedCurve(seed, random);
    const CurveFootPoints<3> feet(curve);
    const double rounding = 1e-10 * StretchOf(seed);  // what a search may miss
    for (int k = 0; k < kPoints; ++k) {
      const Eigen::Vector3d place = curve.At(random.Parameter(curve.basis()));
      const Eigen::Vector3d off = random.Vector(std::pow(10.0, -k % 5));
      const CurveFoot foot = feet.Nearest(place + off);
      EXPECT_LE(foot.distance, off.norm() + rounding);
      EXPECT_LE(foot.lower_bound, off.norm() + rounding);
      EXPECT_TRUE(foot.certified) << foot.lower_bound << " of " << foot.distance;
    }
  }
}

// The distance of a triangle's hull is known; so is that of a hull that holds the origin.
TEST(HullPointTest, IsTheNearestOfAHull) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const double by = std::pow(10.0, random.Integer(0, 6));
    Eigen::Matrix3Xd points(3, 20);
    for (Eigen::Index k = 0; k < points.cols(); ++k)
      points.col(k) = Eigen::Vector3d(1, 1, by).cwiseProduct(random.Vector(1));
    // All of them beyond a plane, three of them on it around its foot point.
    const Eigen::Vector3d normal = random.Vector(1).normalized();
    const double apart = 0.1 + std::abs(random.Vector(1)[0]);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const double height = normal.dot(points.col(k));
      const double wanted = k < 3 ? apart : apart + std::abs(height);
      points.col(k) += (wanted - height) * normal;
    }
    points.col(2) = 3 * apart * normal - points.col(0) - points.col(1);
    const HullPoint hull(points, HUGE_VAL);
    const double size = points.cwiseAbs().maxCoeff();
    EXPECT_LE(hull.lower_bound(), apart + 1e-14 * size);
    EXPECT_GE(hull.lower_bound(), apart - 1e-13 * size);
  }
  Eigen::Matrix3Xd around(3, 4);
  around << 1, -1, 0, 0, 0, 0, 1, -1, 1, 1, -1, -1;
  EXPECT_EQ(HullPoint(around, HUGE_VAL).lower_bound(), 0);
}

}  // namespace batten::internal::stretched_foot_point_test
