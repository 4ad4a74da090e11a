// SPDX-License-Identifier: MIT
#include "batten/geometry/exact_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/reverse.h"
#include "random_splines.h"
#include "tolerances.h"
#include "angles.h"

namespace batten::internal::exact_shape_test {

constexpr unsigned kSeed = 73;
AngleRange Angles(RandomSplines& random) {
  return {random.Coin() ? 0 : random.Real(-7, 7),
          random.Coin() ? 2 * kPi : random.Real(0.1, 2 * kPi)};
}

Interval Latitudes(RandomSplines& random) {
  return {random.Coin() ? -kPi / 2 : random.Real(-1.5, -0.1),
          random.Coin() ? kPi / 2 : random.Real(0.1, 1.5)};
}

Frame Place(RandomSplines& random, double far) {
  return Frame(random.Vector(far), random.Vector(1), random.Vector(1));
}

// Any exact surface of the kind.
ExactSurface Any(int kind, const Frame& frame, RandomSplines& random) {
  const double r = random.Logarithmic(0.1, 10);
  const Interval height{r * random.Real(-2, 0), r * random.Real(0.1, 3)};
  const double other = random.Coin() ? 0 : r * random.Real(0.1, 0.9);
  switch (kind) {
    case 0:
      return ExactPlane{frame, height, {-r, 2 * r}};
    case 1:
      return ExactCylinder{frame, r, height, Angles(random)};
    case 2:
      return random.Coin() ? ExactCone{frame, r, other, height, Angles(random)}
                           : ExactCone{frame, other, r, height, Angles(random)};
    case 3:
      return ExactSphere{frame, r, Angles(random), Latitudes(random)};
    default:
      return ExactTorus{frame, r, r * random.Real(0.05, 0.95), Angles(random), Angles(random)};
  }
}

double Gap(const NurbsSurface& a, const NurbsSurface& b) {
  return (a.control_points() - b.control_points()).cwiseAbs().maxCoeff();
}

void ExpectSameShape(const ExactSurface& shape, const Frame& at) {
  const NurbsSurface made = ToNurbs(shape);
  const auto found = ExactShapeOf(made);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->index(), shape.index());
  const double largest = made.control_points().cwiseAbs().maxCoeff();
  EXPECT_LE(Gap(ToNurbs(*found), made), 1e-13 * 50 + 8 * 0x1p-52 * largest);
  if (const auto* sphere = std::get_if<ExactSphere>(&*found)) {
    EXPECT_LE((sphere->frame.origin() - at.origin()).norm(), kRounding * 100 + 1e-12 * largest);
  }
}

TEST(ExactShapeTest, WhatIsMadeIsFoundAgain) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 500; ++k) {
    for (const double far : {0.0, 10.0}) {
      SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", case " << k << ", far " << far);
      const Frame frame = k < 5 && far == 0 ? Frame() : Place(random, far);
      ExpectSameShape(Any(k % 5, frame, random), frame);
    }
  }
}

TEST(ExactShapeTest, AnyUnitDoes) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 100; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", case " << k);
    const double unit = k % 2 == 0 ? 1e-6 : 1e6;
    const NurbsSurface made = ToNurbs(Any(k % 5, Place(random, 1), random));
    const NurbsSurface scaled(
        made.basis_u(), made.basis_v(), unit * made.control_points(), made.weights());
    const auto found = ExactShapeOf(scaled);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->index(), static_cast<size_t>(k % 5));
  }
}

// Five thousand kilometres from the origin in metres coordinates keep nine digits after the point.
// What those do not determine, short arcs of small shapes and some poles, stays free-form.
TEST(ExactShapeTest, PartsFarFromTheOriginAreFoundToo) {
  RandomSplines random(kSeed);
  int found = 0;
  for (int k = 0; k < 200; ++k) {
    const Frame frame = Place(random, 5e6);
    found += ExactShapeOf(ToNurbs(Any(k % 5, frame, random))).has_value();
  }
  EXPECT_GE(found, 170);
}

TEST(ExactShapeTest, OtherParameterizationsAndOtherShapesAreNone) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 100; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", case " << k);
    const NurbsSurface made = ToNurbs(Any(k % 5, Place(random, 1), random));
    EXPECT_FALSE(ExactShapeOf(Reversed(made, Direction::kV)).has_value() && k % 5 > 0);
    EXPECT_FALSE(ExactShapeOf(Elevated(made, Direction::kU, 1)).has_value());
    EXPECT_FALSE(ExactShapeOf(InsertKnot(made, Direction::kU, 0.3, 1)).has_value());
    Eigen::Matrix3Xd points = made.control_points();
    const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
    points.col(random.Integer(0, static_cast<int>(points.cols()) - 1)).array() += 1e-10 * size;
    EXPECT_FALSE(
        ExactShapeOf(NurbsSurface(made.basis_u(), made.basis_v(), points, made.weights())));
    const NurbsSurface random_surface = random.Surface(2, random.Integer(1, 2), true);
    EXPECT_FALSE(ExactShapeOf(random_surface).has_value());
  }
}

TEST(ExactShapeTest, DegenerateNetsAreNone) {
  const NurbsSurface cylinder = MakeCylinder(Frame(), 1, {0, 1});
  const Eigen::Matrix3Xd flat = Eigen::Matrix3Xd::Zero(3, 18);
  EXPECT_FALSE(
      ExactShapeOf(NurbsSurface(cylinder.basis_u(), cylinder.basis_v(), flat, cylinder.weights())));
  Eigen::Matrix3Xd line = flat;
  for (int k = 0; k < 18; ++k) line(0, k) = k;
  EXPECT_FALSE(
      ExactShapeOf(NurbsSurface(cylinder.basis_u(), cylinder.basis_v(), line, cylinder.weights())));
  // A flat ring has no height: no cone either.
  Eigen::Matrix3Xd ring = cylinder.control_points();
  for (int k = 0; k < 18; ++k) ring.col(k) << (k % 2 + 1) * ring.col(k).head<2>(), 0;
  EXPECT_FALSE(
      ExactShapeOf(NurbsSurface(cylinder.basis_u(), cylinder.basis_v(), ring, cylinder.weights())));
  EXPECT_FALSE(ExactShapeOf(MakeBilinear({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0})));
  EXPECT_FALSE(ExactShapeOf(MakeBilinear({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1})));
  EXPECT_FALSE(ExactShapeOf(MakeBilinear({0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {1.5, 1, 0})));
}

TEST(ExactShapeTest, LinesAndArcsAreFoundAgain) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", case " << k);
    const Frame frame = Place(random, 10);
    const double radius = random.Logarithmic(0.1, 10);
    const NurbsCurve<3> arc = MakeArc(frame, radius, Angles(random));
    const auto found = ExactShapeOf(arc);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(std::get<ExactArc>(*found).radius, radius, kRounding * 10);
    EXPECT_LE((ToNurbs(*found).control_points() - arc.control_points()).cwiseAbs().maxCoeff(),
              kRounding * 10);
    EXPECT_FALSE(ExactShapeOf(MakeEllipseArc(frame, radius, 1.001 * radius)).has_value());
    EXPECT_TRUE(ExactShapeOf(Reversed(arc)).has_value());  // about the opposite axis
    const NurbsCurve<3> line = MakeLine<3>(random.Vector(5), random.Vector(5));
    EXPECT_TRUE(ToNurbs(ExactShapeOf(line).value()) == line);
  }
}

}  // namespace batten::internal::exact_shape_test
