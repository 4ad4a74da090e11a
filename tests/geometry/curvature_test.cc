// SPDX-License-Identifier: MIT
#include "batten/geometry/curvature.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "batten/geometry/nurbs_curve.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten {
namespace {

TEST(CurvatureTest, OfASphereIsOneOverTheRadiusEverywhere) {
  RandomSplines random(1);
  for (const double radius : {1e-9, 0.3, 1.0, 7.0, 1e9}) {
    SCOPED_TRACE("radius " + std::to_string(radius));
    const NurbsSurface sphere = Sphere(radius);
    for (int trial = 0; trial < 50; ++trial) {
      const auto curvature = CurvatureOf(sphere.JetAt(random.Real(0, 1), random.Real(0.05, 0.95)));
      ASSERT_TRUE(curvature);
      // The normal looks outward, the sphere bends away from it.
      EXPECT_NEAR(curvature->mean * radius, -1, kIterated);
      EXPECT_NEAR(curvature->gaussian * radius * radius, 1, kIterated);
      // A double root of the quadratic: half the digits.
      EXPECT_NEAR(curvature->principal_low * radius, -1, kHalfDigits);
      EXPECT_NEAR(curvature->principal_high * radius, -1, kHalfDigits);
    }
  }
}

TEST(CurvatureTest, OfACylinderIsZeroAlongAndOneOverTheRadiusAround) {
  RandomSplines random(2);
  const NurbsSurface cylinder = Cylinder(2.5, 4);
  for (int trial = 0; trial < 50; ++trial) {
    const auto curvature = CurvatureOf(cylinder.JetAt(random.Real(0, 1), random.Real(0, 1)));
    ASSERT_TRUE(curvature);
    EXPECT_NEAR(curvature->gaussian, 0, kRounding);
    EXPECT_NEAR(curvature->mean, -0.2, kRounding);
    EXPECT_NEAR(curvature->principal_low, -0.4, kRounding);
    EXPECT_NEAR(curvature->principal_high, 0, kRounding);
  }
}

TEST(CurvatureTest, OfATorusFollowsTheDistanceFromTheAxis) {
  RandomSplines random(3);
  const double major = 3, minor = 0.8;
  const NurbsSurface torus = Torus(major, minor);
  for (int trial = 0; trial < 100; ++trial) {
    const SurfaceJet jet = torus.JetAt(random.Real(0, 1), random.Real(0, 1));
    const auto curvature = CurvatureOf(jet);
    ASSERT_TRUE(curvature);
    const double distance = jet.point.head<2>().norm();
    const double around = -1 / minor, along = -(distance - major) / (minor * distance);
    EXPECT_NEAR(curvature->gaussian, around * along, kIterated);
    EXPECT_NEAR(curvature->mean, (around + along) / 2, kIterated);
    EXPECT_NEAR(curvature->principal_low, around, kIterated);
    EXPECT_NEAR(curvature->principal_high, along, kIterated);
  }
}

TEST(CurvatureTest, OfASaddleHasBothSigns) {
  // z = x y: at the origin the principal curvatures are −1 and 1, the mean is 0.
  const NurbsSurface saddle(
      SplineBasis(1, {-1, -1, 1, 1}),
      SplineBasis(1, {-1, -1, 1, 1}),
      Eigen::Matrix<double, 3, 4>{{-1, -1, 1, 1}, {-1, 1, -1, 1}, {1, -1, -1, 1}});
  const auto curvature = CurvatureOf(saddle.JetAt(0, 0));
  ASSERT_TRUE(curvature);
  EXPECT_NEAR(curvature->gaussian, -1, kRounding);
  EXPECT_NEAR(curvature->mean, 0, kRounding);
  EXPECT_NEAR(curvature->principal_low, -1, kRounding);
  EXPECT_NEAR(curvature->principal_high, 1, kRounding);
}

TEST(CurvatureTest, OfAPlaneVanishes) {
  const SurfaceJet jet{{1, 2, 3}, {1, 0, 0}, {0.5, 2, 0}, {3, 1, 0}, {0, 1, 0}, {1, 1, 0}};
  const auto curvature = CurvatureOf(jet);
  ASSERT_TRUE(curvature);
  EXPECT_EQ(curvature->gaussian, 0);
  EXPECT_EQ(curvature->mean, 0);
}

TEST(CurvatureTest, DoesNotDependOnTheParameters) {
  // With u = a s + b s t, v = c t: another parameterization of the same surface.
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const SurfaceJet jet{random.Vector(1),
                         random.Vector(1),
                         random.Vector(1),
                         random.Vector(1),
                         random.Vector(1),
                         random.Vector(1)};
    const double a = random.Real(0.5, 2), b = random.Real(-1, 1), c = random.Real(0.5, 2);
    const double s = random.Real(-1, 1);  // at t = 0: u_s = a, u_t = b s, u_st = b
    SurfaceJet other = jet;
    other.du = a * jet.du;
    other.dv = b * s * jet.du + c * jet.dv;
    other.duu = a * a * jet.duu;
    other.duv = a * b * s * jet.duu + a * c * jet.duv + b * jet.du;
    other.dvv = b * b * s * s * jet.duu + 2 * b * s * c * jet.duv + c * c * jet.dvv;
    const auto before = CurvatureOf(jet), after = CurvatureOf(other);
    ASSERT_TRUE(before && after);
    const double size = std::abs(before->principal_low) + std::abs(before->principal_high);
    // Directions of random derivatives are at worst some degrees apart.
    EXPECT_NEAR(after->gaussian, before->gaussian, kIterated * size * size);
    EXPECT_NEAR(after->mean, before->mean, kIterated * size);
  }
}

TEST(CurvatureTest, PrincipalCurvaturesHaveTheMeanAndTheProduct) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const auto k = CurvatureOf({random.Vector(1),
                                random.Vector(1),
                                random.Vector(1),
                                random.Vector(1),
                                random.Vector(1),
                                random.Vector(1)});
    ASSERT_TRUE(k);
    const double size = std::abs(k->principal_low) + std::abs(k->principal_high);
    EXPECT_LE(k->principal_low, k->principal_high);
    EXPECT_NEAR(k->principal_low + k->principal_high, 2 * k->mean, kRounding * size);
    EXPECT_NEAR(k->principal_low * k->principal_high, k->gaussian, kRounding * size * size);
  }
}

TEST(CurvatureTest, IsNoneWithoutANormal) {
  const Eigen::Vector3d x(1, 0, 0), zero = Eigen::Vector3d::Zero();
  EXPECT_FALSE(CurvatureOf(SurfaceJet{zero, x, zero, x, x, x}));
  EXPECT_FALSE(CurvatureOf(SurfaceJet{zero, x, -3 * x, x, x, x}));
  EXPECT_FALSE(CurvatureOf(zero, x, x));
}

TEST(CurvatureTest, OfAHelixIsConstant) {
  const double r = 2, pitch = 0.5;  // (r cos t, r sin t, pitch t)
  const double squared = r * r + pitch * pitch;
  for (const double t : {0.0, 0.7, 2.0, 5.0}) {
    const double c = std::cos(t), s = std::sin(t);
    for (const double hand : {1.0, -1.0}) {  // a left-handed helix has negative torsion
      const auto k = CurvatureOf(Eigen::Vector3d(-r * s, r * c, hand * pitch),
                                 Eigen::Vector3d(-r * c, -r * s, 0),
                                 Eigen::Vector3d(r * s, -r * c, 0));
      ASSERT_TRUE(k);
      EXPECT_NEAR(k->curvature, r / squared, kRounding);
      EXPECT_NEAR(k->torsion, hand * pitch / squared, kRounding);
    }
  }
}

TEST(CurvatureTest, OfTheTwistedCubicMatchesItsFormulas) {
  // C(t) = (t, t², t³) on [0, 1] as a Bézier curve.
  const NurbsCurve<3> cubic(
      SplineBasis::Uniform(3, 4, 0, 1),
      Eigen::Matrix<double, 3, 4>{{0, 1.0 / 3, 2.0 / 3, 1}, {0, 0, 1.0 / 3, 1}, {0, 0, 0, 1}});
  for (const double t : {0.0, 0.3, 0.5, 1.0}) {
    const Eigen::Matrix3Xd d = cubic.Derivatives(t, 3);
    const auto k = CurvatureOf(d.col(1), d.col(2), d.col(3));
    ASSERT_TRUE(k);
    const double a = 9 * std::pow(t, 4) + 9 * t * t + 1, b = 9 * std::pow(t, 4) + 4 * t * t + 1;
    EXPECT_NEAR(k->curvature, 2 * std::sqrt(a) / std::pow(b, 1.5), kRounding);
    EXPECT_NEAR(k->torsion, 3 / a, kRounding);
  }
}

TEST(CurvatureTest, OfACircleInThePlaneIsOneOverTheRadiusWithoutTorsion) {
  const NurbsCurve<2> circle = Circle(0.2);
  for (const double u : {0.0, 0.1, 0.33, 0.5, 0.97}) {
    Eigen::Matrix3Xd d = Eigen::Matrix3Xd::Zero(3, 4);
    d.topRows<2>() = circle.Derivatives(u, 3);
    const auto k = CurvatureOf(d.col(1), d.col(2), d.col(3));
    ASSERT_TRUE(k);
    EXPECT_NEAR(k->curvature * 0.2, 1, kRounding);
    EXPECT_EQ(k->torsion, 0);
  }
}

TEST(CurvatureTest, OfALineVanishes) {
  const auto k =
      CurvatureOf(Eigen::Vector3d(1, 2, 2), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  ASSERT_TRUE(k);
  EXPECT_EQ(k->curvature, 0);
  EXPECT_EQ(k->torsion, 0);
}

}  // namespace
}  // namespace batten
