// SPDX-License-Identifier: MIT
#include "batten/geometry/curvature.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <string>

#include "batten/geometry/curvature_range.h"
#include "batten/geometry/nurbs_curve.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::curvature_test {

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
      EXPECT_NEAR(curvature->principal_low * radius, -1, kIterated);
      EXPECT_NEAR(curvature->principal_high * radius, -1, kIterated);
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

// The normal curvature of a direction of the tangent plane, from the derivatives of a curve in the
// surface that leaves along it: Meusnier's theorem.
double NormalCurvature(const SurfaceJet& jet, const Eigen::Vector3d& along) {
  const Eigen::Matrix<double, 3, 2> tangents{
      {jet.du[0], jet.dv[0]}, {jet.du[1], jet.dv[1]}, {jet.du[2], jet.dv[2]}};
  const Eigen::Vector2d a = tangents.colPivHouseholderQr().solve(along);
  const Eigen::Vector3d bend =
      a[0] * a[0] * jet.duu + 2 * a[0] * a[1] * jet.duv + a[1] * a[1] * jet.dvv;
  return bend.dot(*UnitNormal(jet)) / along.squaredNorm();
}

TEST(PrincipalDirectionsTest, AreTangentPerpendicularAndExtreme) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const SurfaceJet jet{random.Vector(1),
                         random.Vector(1),
                         random.Vector(1),
                         random.Vector(1),
                         random.Vector(1),
                         random.Vector(1)};
    const auto k = CurvatureOf(jet);
    const auto directions = PrincipalDirectionsOf(jet);
    ASSERT_TRUE(k && directions);
    const double size = std::abs(k->principal_low) + std::abs(k->principal_high);
    EXPECT_NEAR(directions->low.norm(), 1, kRounding);
    EXPECT_NEAR(directions->high.norm(), 1, kRounding);
    EXPECT_NEAR(directions->low.dot(directions->high), 0, kRounding);
    EXPECT_NEAR(directions->low.dot(*UnitNormal(jet)), 0, kRounding);
    EXPECT_NEAR(directions->high.dot(*UnitNormal(jet)), 0, kRounding);
    EXPECT_NEAR(NormalCurvature(jet, directions->low), k->principal_low, kIterated * size);
    EXPECT_NEAR(NormalCurvature(jet, directions->high), k->principal_high, kIterated * size);
    for (int trial = 0; trial < 20; ++trial) {
      const double here =
          NormalCurvature(jet, random.Real(-1, 1) * jet.du + random.Real(-1, 1) * jet.dv);
      EXPECT_GE(here, k->principal_low - kIterated * size);
      EXPECT_LE(here, k->principal_high + kIterated * size);
    }
  }
}

TEST(PrincipalDirectionsTest, OfACylinderAreTheRulingAndTheCircle) {
  const NurbsSurface cylinder = Cylinder(2.5, 4);
  for (const double u : {0.0, 0.1, 0.3, 0.9}) {
    const auto directions = PrincipalDirectionsOf(cylinder.JetAt(u, 0.4));
    ASSERT_TRUE(directions);
    EXPECT_NEAR(std::abs(directions->high.z()), 1, kRounding);
    EXPECT_NEAR(directions->low.z(), 0, kRounding);
  }
}

TEST(CurvatureAtTest, OfASphereIsTheSameAtItsPoles) {
  RandomSplines random(6);
  for (const double radius : {1e-9, 0.3, 1.0, 1e9}) {
    SCOPED_TRACE("radius " + std::to_string(radius));
    const NurbsSurface sphere = Sphere(radius);
    for (int trial = 0; trial < 20; ++trial) {
      const double u = random.Parameter(sphere.basis_u());
      for (const double v : {0.0, 1e-15, 1e-10, 1e-6, 0.5, 1 - 1e-7, 1 - 1e-16, 1.0}) {
        const auto k = CurvatureAt(sphere, u, v);
        ASSERT_TRUE(k) << v;
        // At a distance d from a pole the rounding is ε/d, and inside 1e-8 the limit's.
        EXPECT_NEAR(k->mean * radius, -1, kHalfDigits);
        EXPECT_NEAR(k->gaussian * radius * radius, 1, kHalfDigits);
        EXPECT_NEAR(k->principal_low * radius, -1, kHalfDigits);
        EXPECT_NEAR(k->principal_high * radius, -1, kHalfDigits);
        if (v != 0 && v != 1) continue;
        EXPECT_NEAR(k->mean * radius, -1, kIterated);
        EXPECT_NEAR(k->principal_low * radius, -1, kIterated);
        EXPECT_NEAR(k->principal_high * radius, -1, kIterated);
      }
    }
  }
}

TEST(CurvatureAtTest, OfAnEllipsoidOfRevolutionAtItsPolesIsHeightOverRadiusSquared) {
  const NurbsSurface sphere = Sphere(1);
  const NurbsSurface flat(sphere.basis_u(),
                          sphere.basis_v(),
                          Eigen::Vector3d(2, 2, 0.5).asDiagonal() * sphere.control_points(),
                          sphere.weights());
  for (const double u : {0.0, 0.2, 0.25, 0.9, 1.0}) {
    const auto k = CurvatureAt(flat, u, 0);
    ASSERT_TRUE(k);
    EXPECT_NEAR(k->mean, -0.5 / 4, kIterated);
    EXPECT_NEAR(k->gaussian, 0.5 * 0.5 / 16, kIterated);
  }
  // With three axes the pole is no umbilic; its principal curvatures are c/a² and c/b².
  const NurbsSurface long_one(sphere.basis_u(),
                              sphere.basis_v(),
                              Eigen::Vector3d(2, 1, 0.5).asDiagonal() * sphere.control_points(),
                              sphere.weights());
  for (const double u : {0.0, 0.2, 0.25, 0.9, 1.0}) {
    const auto k = CurvatureAt(long_one, u, 1);
    ASSERT_TRUE(k);
    EXPECT_NEAR(k->principal_low, -0.5, kIterated);
    EXPECT_NEAR(k->principal_high, -0.125, kIterated);
  }
}

TEST(CurvatureAtTest, OfAConeIsNoneAtItsTipAndExactElsewhere) {
  const NurbsSurface cone = Cone(3, 4);
  for (const double u : {0.0, 0.2, 0.6}) {
    EXPECT_FALSE(CurvatureAt(cone, u, 0));
    for (const double v : {1e-3, 0.5, 1.0}) {
      const auto k = CurvatureAt(cone, u, v);
      ASSERT_TRUE(k);
      // One over the distance to the axis along the normal: 3 v · 5/4.
      EXPECT_NEAR(k->principal_low * 3 * v * 1.25, -1, kIterated);
      EXPECT_NEAR(k->principal_high * v, 0, kIterated);
    }
  }
}

TEST(CurvatureAtTest, WhereRegularIsThatOfTheJet) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = random.Surface(random.Integer(1, 4), random.Integer(1, 4), false);
    const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
    const auto a = CurvatureAt(surface, u, v), b = CurvatureOf(surface.JetAt(u, v));
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->mean, b->mean);
  }
}

TEST(CurvatureRangeTest, OfExactShapesIsKnown) {
  for (const double r : {1e-9, 1.0, 1e9}) {
    SCOPED_TRACE("size " + std::to_string(r));
    const auto expect =
        [&](const std::optional<CurvatureInterval>& range, double low, double high) {
          ASSERT_TRUE(range);
          EXPECT_NEAR(range->min * r, low, kIterated);
          EXPECT_NEAR(range->max * r, high, kIterated);
        };
    expect(CurvatureRange(Circle(r)), 1, 1);
    expect(CurvatureRange(Sphere(r)), -1, -1);
    expect(CurvatureRange(Cylinder(r, r)), -1, 0);
    expect(CurvatureRange(Torus(3 * r, r)), -1, 0.5);
    const auto cone = CurvatureRange(Cone(r, r));
    ASSERT_TRUE(cone);
    EXPECT_EQ(cone->min, -std::numeric_limits<double>::infinity());
    EXPECT_NEAR(cone->max * r, 0, kIterated);
  }
  // An ellipse with half axes a > b: from b/a² to a/b².
  const NurbsCurve<2> circle = Circle(1);
  const NurbsCurve<2> ellipse(circle.basis(),
                              Eigen::Vector2d(5, 0.5).asDiagonal() * circle.control_points(),
                              circle.weights());
  const auto range = CurvatureRange(ellipse);
  ASSERT_TRUE(range);
  EXPECT_NEAR(range->min, 0.02, kIterated);
  EXPECT_NEAR(range->max, 20, kIterated * 20);
}

TEST(CurvatureRangeTest, HoldsTheCurvatureOfDenseSamples) {
  for (unsigned seed = 0; seed < 25; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const auto curve = random.Curve<3>(random.Integer(2, 7), random.Coin());
    const auto range = CurvatureRange(curve);
    ASSERT_TRUE(range);
    const double lower = curve.basis().lower(), width = curve.basis().upper() - lower;
    for (int k = 0; k <= 2000; ++k) {
      const auto here = CurvatureAt(curve, lower + width * k / 2000);
      ASSERT_TRUE(here);
      EXPECT_GE(here->curvature, range->min * (1 - kHalfDigits) - kIterated);
      EXPECT_LE(here->curvature, range->max * (1 + kHalfDigits));
    }
    const NurbsSurface sheet = random.Sheet(random.Integer(2, 4), random.Integer(2, 4), 0.5);
    const auto bounds = CurvatureRange(sheet);
    ASSERT_TRUE(bounds);
    for (int k = 0; k < 2000; ++k) {
      const auto here =
          CurvatureAt(sheet, random.Parameter(sheet.basis_u()), random.Parameter(sheet.basis_v()));
      ASSERT_TRUE(here);
      EXPECT_GE(here->principal_low, bounds->min - kHalfDigits);
      EXPECT_LE(here->principal_high, bounds->max + kHalfDigits);
    }
  }
}

TEST(CurvatureRangeTest, IsUnboundedAtACuspAndNoneAtAPoint) {
  const NurbsCurve<2> cusp(SplineBasis::Uniform(3, 4, 0, 1),
                           Eigen::Matrix<double, 2, 4>{{0, 0, 1.0 / 3, 1}, {0, 0, 0, 1}});
  EXPECT_EQ(CurvatureRange(cusp)->max, std::numeric_limits<double>::infinity());
  const NurbsCurve<2> point(cusp.basis(), Eigen::Matrix<double, 2, 4>::Ones());
  EXPECT_FALSE(CurvatureRange(point));
  const NurbsCurve<2> line(SplineBasis::Uniform(1, 3, 0, 1),
                           Eigen::Matrix<double, 2, 3>{{0, 1, 2}, {0, 2, 3}});
  EXPECT_EQ(CurvatureRange(line)->min, 0);
  EXPECT_EQ(CurvatureRange(line)->max, 0);
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

}  // namespace batten::internal::curvature_test
