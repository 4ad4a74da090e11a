// SPDX-License-Identifier: MIT
#include "batten/geometry/surface_area.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "exact_shapes.h"
#include "fixtures.h"
#include "quadrature.h"
#include "random_splines.h"
#include "tolerances.h"
#include "angles.h"

namespace batten::internal::surface_area_test {

double Reference(const NurbsSurface& surface, int parts) {
  const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
  double sum = 0;
  for (const int su : bu.Spans()) {
    for (const int sv : bv.Spans()) {
      const auto over_v = [&](double u) {
        return CompositeGauss(
            [&](double v) {
              const SurfaceJet jet = surface.JetAt(u, v);
              return jet.du.cross(jet.dv).norm();
            },
            bv.knots()[sv],
            bv.knots()[sv + 1],
            parts);
      };
      sum += CompositeGauss(over_v, bu.knots()[su], bu.knots()[su + 1], parts);
    }
  }
  return sum;
}

NurbsSurface WithPoints(const NurbsSurface& surface, const Eigen::Matrix3Xd& points) {
  return NurbsSurface(surface.basis_u(), surface.basis_v(), points, surface.weights());
}

TEST(SurfaceAreaTest, OfExactShapesIsTheirFormula) {
  for (const double r : {1e-9, 0.3, 1.0, 1e9}) {
    SCOPED_TRACE("size " + std::to_string(r));
    EXPECT_NEAR(Area(Sphere(r)) / (4 * kPi * r * r), 1, kRounding);
    EXPECT_NEAR(Area(Torus(3 * r, r)) / (12 * kPi * kPi * r * r), 1, kRounding);
    EXPECT_NEAR(Area(Cylinder(r, 2 * r)) / (4 * kPi * r * r), 1, kRounding);
    EXPECT_NEAR(Area(Cone(3 * r, 4 * r)) / (15 * kPi * r * r), 1, kRounding);
  }
}

TEST(SurfaceAreaTest, OfASphereZoneGrowsWithItsHeight) {
  const NurbsSurface sphere = Sphere(2);
  for (const double v : {0.05, 0.3, 0.5, 0.9}) {
    const double height = sphere.At(0, v).z() + 2;
    EXPECT_NEAR(Area(sphere, 0, 1, 0, v) / (4 * kPi * height), 1, kIterated);
    EXPECT_NEAR(Area(sphere, 0.25, 0.75, 0, v) / (2 * kPi * height), 1, kIterated);
  }
}

TEST(SurfaceAreaTest, OfAFlatPieceIsThatOfItsOutlineForAnyParameters) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = random.Integer(2, 6), q = random.Integer(2, 6);
    // The Greville grid is the identity; its inner points moved a little leave the outline alone.
    Eigen::Matrix3Xd points(3, (p + 1) * (q + 1));
    for (int i = 0; i <= p; ++i) {
      for (int j = 0; j <= q; ++j) {
        const bool inner = i > 0 && i < p && j > 0 && j < q;
        points.col(i * (q + 1) + j) << double(i) / p + inner * random.Real(-0.05, 0.05),
            double(j) / q + inner * random.Real(-0.05, 0.05), 0;
      }
    }
    const NurbsSurface flat(
        SplineBasis::Uniform(p, p + 1, 0, 1), SplineBasis::Uniform(q, q + 1, 0, 1), points);
    EXPECT_NEAR(Area(flat), 1, kIterated);
  }
}

TEST(SurfaceAreaTest, CountsAFoldTwice) {
  // x = (u − a)², y = v: covers [0, a²] and [0, (1−a)²].
  for (const double a : {0.5, 0.3, 1e-2, 4e-3, 1e-3}) {
    SCOPED_TRACE("a = " + std::to_string(a));
    Eigen::Matrix3Xd points(3, 6);
    const double x[3] = {a * a, a * a - a, (1 - a) * (1 - a)};
    for (int i = 0; i < 3; ++i) {
      points.col(2 * i) << x[i], 0, 0;
      points.col(2 * i + 1) << x[i], 1, 0;
    }
    const NurbsSurface folded(
        SplineBasis::Uniform(2, 3, 0, 1), SplineBasis::Uniform(1, 2, 0, 1), points);
    EXPECT_NEAR(Area(folded), a * a + (1 - a) * (1 - a), kIterated);
  }
}

TEST(SurfaceAreaTest, AgreesWithIndependentQuadrature) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface sheet = random.Sheet(random.Integer(1, 5),
                                            random.Integer(1, 5),
                                            0.8,
                                            {.clamped = random.Coin(), .most_spans = 2});
    const NurbsSurface rational(sheet.basis_u(),
                                sheet.basis_v(),
                                sheet.control_points(),
                                random.Weights(sheet.weights().size(), 0.3, 3));
    EXPECT_NEAR(Reference(sheet, 16) / Area(sheet), 1, kIterated);
    EXPECT_NEAR(Reference(rational, 16) / Area(rational), 1, kIterated);
  }
}

TEST(SurfaceAreaTest, IsAdditive) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = random.Surface(
        random.Integer(1, 3),
        random.Integer(1, 3),
        random.Coin(),
        {.clamped = random.Coin(), .most_spans = 2, .periodic = random.Integer(0, 3) == 0});
    const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
    const double u = random.Parameter(bu), v = random.Parameter(bv);
    const double parts =
        Area(surface, bu.lower(), u, bv.lower(), v) + Area(surface, u, bu.upper(), bv.lower(), v) +
        Area(surface, bu.lower(), u, v, bv.upper()) + Area(surface, u, bu.upper(), v, bv.upper());
    // One period of few knots may hold a point or a line only.
    const double whole = Area(surface);
    EXPECT_NEAR(parts, whole, kIterated * std::max(whole, 1e-6));
  }
}

TEST(SurfaceAreaTest, DoesNotDependOnPlaceAndScales) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = random.Surface(
        random.Integer(1, 3), random.Integer(1, 3), random.Coin(), {.most_spans = 2});
    const double area = Area(surface);
    const Eigen::Matrix3Xd turned =
        (random.Orthogonal() * surface.control_points()).colwise() + random.Vector(5);
    for (const double scale : {1e-9, 1.0, 1e9}) {
      const double moved = Area(WithPoints(surface, scale * turned));
      EXPECT_NEAR(moved / (scale * scale * area), 1, kIterated);
    }
  }
}

TEST(SurfaceAreaTest, IsExactAtCollapsedAndCoincidentCorners) {
  // A collapsed edge: the triangle (0,0), (1,0), (1,1) as a bilinear patch, then one corner of a
  // biquadratic sheet pulled together, by composite rules over ever smaller parts.
  const NurbsSurface triangle(
      SplineBasis::Uniform(1, 2, 0, 1),
      SplineBasis::Uniform(1, 2, 0, 1),
      Eigen::Matrix<double, 3, 4>{{0, 0, 1, 1}, {0, 0, 0, 1}, {0, 0, 0, 0}});
  EXPECT_NEAR(Area(triangle), 0.5, kRounding);
  RandomSplines random(3);
  const NurbsSurface sheet = random.Sheet(2, 2, 0.5, {.most_spans = 1});
  Eigen::Matrix3Xd points = sheet.control_points();
  points.col(3) = points.col(0);  // P_10 = P_00
  const NurbsSurface pulled = WithPoints(sheet, points);
  // The integrand is |linear| about the corner: halving the parts takes the error to an eighth.
  const double coarse = Reference(pulled, 40), fine = Reference(pulled, 80);
  EXPECT_NEAR(Area(pulled) / (fine + (fine - coarse) / 7), 1, kIterated);
}

TEST(SurfaceAreaTest, OfALineOrAPointIsZero) {
  RandomSplines random(1);
  const NurbsSurface sheet = random.Sheet(3, 3, 0.5, {.most_spans = 3});
  EXPECT_EQ(Area(WithPoints(sheet, 0 * sheet.control_points())), 0);
  Eigen::Matrix3Xd line = sheet.control_points();
  for (int i = 0; i < line.cols(); ++i) line.col(i) = line(0, i) * Eigen::Vector3d(1, 2, 3) / 7;
  EXPECT_LE(Area(WithPoints(sheet, line)), 1e-13 * line.squaredNorm());
}

TEST(SurfaceAreaTest, GoesAcrossTheSeamOfAPeriodicSurface) {
  RandomSplines random(5);
  const NurbsSurface surface =
      random.Surface(3, 2, true, {.most_spans = 3, .periodic = true}, {.most_spans = 2});
  const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
  const double period = bu.upper() - bu.lower(), a = bu.lower() + 0.7 * period;
  const double b = a + 0.6 * period;
  EXPECT_NEAR((Area(surface, a, b, bv.lower(), bv.upper()) +
               Area(surface, b, a + period, bv.lower(), bv.upper())) /
                  Area(surface),
              1,
              kIterated);
}

TEST(SurfaceAreaTest, RefusesRectanglesThatAreNone) {
  const NurbsSurface cone = Cone(1, 1);
  EXPECT_THROW(Area(cone, 0.5, 0.4, 0, 1), std::invalid_argument);
  EXPECT_THROW(Area(cone, 0, 1, -0.1, 1), std::invalid_argument);
  EXPECT_THROW(Area(cone, 0, 1, 0, 1.1), std::invalid_argument);
  EXPECT_THROW(Area(cone, 0, NAN, 0, 1), std::invalid_argument);
  EXPECT_EQ(Area(cone, 0.3, 0.3, 0, 1), 0);
}

TEST(SurfaceAreaFixturesTest, AreasAgreeWithOtherImplementations) {
  using namespace fixtures;
  int seen = 0;
  CheckAll("measures_curvature.json",
           [&](const Json& input, const Json& expected, double tolerance) {
             if (!expected.contains("area")) return;
             ++seen;
             ExpectClose(Area(Surface(input.at("surface"))), expected.at("area"), tolerance);
           });
  EXPECT_EQ(seen, 8);
}

double Residual(const std::string& kind, const std::vector<double>& a, const Eigen::Vector3d& at) {
  const double distance = std::hypot(at.x(), at.y());
  if (kind == "sphere") return at.squaredNorm() / (a[0] * a[0]) - 1;
  if (kind == "torus") {
    return (std::pow(distance - a[0], 2) + at.z() * at.z()) / (a[1] * a[1]) - 1;
  }
  if (kind == "cylinder") return std::pow(distance / a[0], 2) - 1;
  return distance / (a[0] + at.z() * std::tan(a[1])) - 1;
}

TEST(SurfaceAreaFixturesTest, PrimitivesAreWhatTheirFormulasSay) {
  using namespace fixtures;
  int seen = 0;
  CheckAll("exact_primitives.json", [&](const Json& input, const Json& expected, double tolerance) {
    if (!expected.contains("area")) return;
    ++seen;
    const NurbsSurface surface = Surface(expected.at("one_valid_nurbs"));
    ExpectClose(Area(surface), expected.at("area"), tolerance);
    const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
    for (int i = 0; i <= 30; ++i) {
      for (int j = 0; j <= 30; ++j) {
        const Eigen::Vector3d point = surface.At(bu.lower() + (bu.upper() - bu.lower()) * i / 30,
                                                 bv.lower() + (bv.upper() - bv.lower()) * j / 30);
        EXPECT_NEAR(Residual(input.at("kind"), input.at("parameters"), point),
                    0,
                    expected.at("max_implicit_residual").get<double>());
      }
    }
  });
  EXPECT_EQ(seen, 8);
}

TEST(LongSurfaceAreaTest, OfWildSurfacesIsAdditive) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = random.Surface(random.Integer(1, 6),
                                                random.Integer(1, 6),
                                                random.Coin(),
                                                {.clamped = random.Coin(), .most_spans = 2});
    const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
    const double u = random.Parameter(bu), whole = Area(surface);
    EXPECT_NEAR((Area(surface, bu.lower(), u, bv.lower(), bv.upper()) +
                 Area(surface, u, bu.upper(), bv.lower(), bv.upper())) /
                    whole,
                1,
                kIterated);
  }
}

}  // namespace batten::internal::surface_area_test
