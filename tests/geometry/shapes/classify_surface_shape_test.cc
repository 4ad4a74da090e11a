// SPDX-License-Identifier: MIT
#include "batten/geometry/classify_shape.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/nurbs/homogeneous.h"
#include "dense_samples.h"
#include "exact_shapes.h"
#include "fixtures.h"
#include "random_splines.h"
#include "shape_cases.h"
#include "tolerances.h"

namespace batten::internal::classify_surface_shape_test {

// A surface over richer bases in both directions.
NurbsSurface Richer(const NurbsSurface& surface, int by_u, int by_v, RandomSplines& random) {
  const SplineBasis u = Richer(surface.basis_u(), by_u, random);
  const NurbsSurface first = SurfaceFromHomogeneous(
      surface,
      Direction::kU,
      u,
      Converted(surface.basis_u(), HomogeneousRows(surface, Direction::kU), u));
  const SplineBasis v = Richer(surface.basis_v(), by_v, random);
  return SurfaceFromHomogeneous(
      first,
      Direction::kV,
      v,
      Converted(first.basis_v(), HomogeneousRows(first, Direction::kV), v));
}

// The profile (distance from the axis, height) turned by `sweep` < π from `start`.
NurbsSurface RevolvedPatch(const NurbsCurve<2>& profile, double start, double sweep) {
  const NurbsCurve<2> arc = CircleArc(start, sweep);
  const Eigen::Index m = profile.control_points().cols();
  Eigen::Matrix3Xd points(3, 3 * m);
  Eigen::VectorXd weights(3 * m);
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < m; ++j) {
      points.col(i * m + j) << profile.control_points()(0, j) * arc.control_points().col(i),
          profile.control_points()(1, j);
      weights[i * m + j] = arc.weights()[i] * profile.weights()[j];
    }
  }
  return NurbsSurface(arc.basis(), profile.basis(), points, weights);
}

NurbsCurve<2> Segment(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  Eigen::Matrix2d points;
  points << a, b;
  return NurbsCurve<2>(SplineBasis(1, {0, 0, 1, 1}), points);
}

// A patch of a known shape about the z axis, or with its centre at the origin.
struct KnownPatch {
  enum Kind { kCylinder, kCone, kSphere, kTorus } kind;
  NurbsSurface surface;
  double first, second = 0;  // radius; half angle; radius; major and minor radius
  double smallest_turn;      // the smaller of the angles the normal turns through: the condition
  std::string description;
};

KnownPatch RandomPatch(KnownPatch::Kind kind, double least, RandomSplines& random) {
  const double sweep = random.Logarithmic(least, 3), length = random.Logarithmic(least, 3);
  const double radius = random.Real(0.5, 2), start = random.Real(0, 6);
  std::ostringstream text;
  text << "kind " << kind << ", turned by " << sweep << ", profile " << length;
  switch (kind) {
    case KnownPatch::kCylinder:
      return {kind,
              RevolvedPatch(Segment({radius, 0.3}, {radius, 0.3 + length}), start, sweep),
              radius,
              0,
              sweep,
              text.str()};
    case KnownPatch::kCone: {
      const double angle = random.Real(0.05, 1.5), from = random.Coin() ? 0 : 0.3;
      text << ", half angle " << angle;
      const Eigen::Vector2d direction(std::sin(angle), std::cos(angle));
      return {kind,
              RevolvedPatch(Segment(from * direction, (from + length) * direction), start, sweep),
              angle,
              0,
              sweep * std::cos(angle),
              text.str()};
    }
    case KnownPatch::kSphere: {
      const double low = random.Real(-1.5, 1.4), turn = std::min(length, 1.5 - low);
      return {kind,
              RevolvedPatch(Shifted(CircleArc(low, turn), radius, 0, 0), start, sweep),
              radius,
              0,
              std::min(sweep * std::cos(std::max(std::abs(low), std::abs(low + turn))), turn),
              text.str()};
    }
    default: {
      const double minor = random.Real(0.1, 0.9) * radius, low = random.Real(0, 6);
      text << ", minor " << minor / radius;
      return {kind,
              RevolvedPatch(Shifted(CircleArc(low, length), minor, radius, 0), start, sweep),
              radius,
              minor,
              std::min(sweep, length),
              text.str()};
    }
  }
}

void ExpectKnown(const KnownPatch& known,
                 const Placement& place,
                 const SurfaceShape& shape,
                 double relative) {
  static const char* const kNames[] = {"cylinder", "cone", "sphere", "torus"};
  ASSERT_EQ(NameOf(shape), kNames[known.kind]);
  const Eigen::Vector3d axis = place.turn.col(2), origin = place.shift;
  const double length = relative * place.scale;
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape)) {
    EXPECT_LT(cylinder->axis.cross(axis).norm(), relative);
    EXPECT_LT((cylinder->point - origin).cross(axis).norm(), length);
    EXPECT_NEAR(cylinder->radius, known.first * place.scale, length);
  } else if (const auto* cone = std::get_if<ConeShape>(&shape)) {
    EXPECT_LT((cone->axis - axis).norm(), relative);
    EXPECT_LT((cone->apex - origin).norm(), length);
    EXPECT_NEAR(cone->half_angle, known.first, relative);
  } else if (const auto* sphere = std::get_if<SphereShape>(&shape)) {
    EXPECT_LT((sphere->center - origin).norm(), length);
    EXPECT_NEAR(sphere->radius, known.first * place.scale, length);
  } else if (const auto* torus = std::get_if<TorusShape>(&shape)) {
    EXPECT_LT(torus->axis.cross(axis).norm(), relative);
    EXPECT_LT((torus->center - origin).norm(), length);
    EXPECT_NEAR(torus->major_radius, known.first * place.scale, length);
    EXPECT_NEAR(torus->minor_radius, known.second * place.scale, length);
  }
}

void CheckPatches(unsigned seed, int count, double least) {
  RandomSplines random(seed);
  for (int k = 0; k < count; ++k) {
    const KnownPatch known = RandomPatch(static_cast<KnownPatch::Kind>(k % 4), least, random);
    const int by_u = random.Integer(0, 4), by_v = random.Integer(0, 4);
    const Placement place(random);
    NurbsSurface surface = known.surface;
    if (random.Coin()) surface = Richer(surface, by_u, by_v, random);
    SCOPED_TRACE(::testing::Message() << "seed " << seed << ", case " << k << ": "
                                      << known.description << ", by " << by_u << " " << by_v);
    const double relative = 1e-13 * std::pow(known.smallest_turn, -4) * 1e4;
    ExpectKnown(known, place, ClassifyShape(place.Placed(surface)), relative);
  }
}

TEST(ClassifySurfaceShapeTest, PatchesOfPrimitivesAreRecognizedInEveryForm) {
  CheckPatches(7, 400, 1e-2);
}

TEST(ClassifySurfaceShapeTest, WholePrimitivesAreRecognized) {
  RandomSplines random(8);
  for (int k = 0; k < 20; ++k) {
    const Placement place(random);
    EXPECT_EQ(NameOf(ClassifyShape(place.Placed(Sphere(random.Real(0.1, 10))))), "sphere");
    EXPECT_EQ(NameOf(ClassifyShape(place.Placed(Cylinder(random.Real(0.1, 10), 1)))), "cylinder");
    EXPECT_EQ(NameOf(ClassifyShape(place.Placed(Cone(random.Real(0.1, 10), 1)))), "cone");
    const double minor = random.Real(0.1, 8);  // rings, and spindles whole
    const SurfaceShape torus = ClassifyShape(place.Placed(Torus(3, minor)));
    ASSERT_EQ(NameOf(torus), "torus") << minor;
    EXPECT_NEAR(
        std::get<TorusShape>(torus).minor_radius, minor * place.scale, kIterated * place.scale);
    EXPECT_NEAR(std::get<TorusShape>(torus).major_radius, 3 * place.scale, kIterated * place.scale);
    const NurbsSurface nappes = RevolvedPatch(Segment({-1, -2}, {0.5, 1}), 0, 2);
    EXPECT_EQ(NameOf(ClassifyShape(place.Placed(nappes))), "cone");
  }
}

// Any net in a plane, weights and all.
TEST(ClassifySurfaceShapeTest, AnyFormOfAPlaneIsAPlane) {
  RandomSplines random(9);
  for (int k = 0; k < 100; ++k) {
    SCOPED_TRACE(::testing::Message() << "seed 9, case " << k);
    const NurbsSurface any = random.Surface(random.Integer(1, 6),
                                            random.Integer(1, 6),
                                            random.Coin(),
                                            {.clamped = random.Coin(), .most_spans = 3});
    Eigen::Matrix3Xd points = any.control_points();
    points.row(2).setZero();
    const NurbsSurface flat(any.basis_u(), any.basis_v(), points, any.weights());
    const Placement place(random);
    const SurfaceShape shape = ClassifyShape(place.Placed(flat));
    ASSERT_EQ(NameOf(shape), "plane");
    const auto& plane = std::get<PlaneShape>(shape);
    EXPECT_LT(plane.normal.cross(place.turn.col(2)).norm(), kIterated);
    // One control point off the plane by about a millionth: the surface is as far off one plane as
    // its heights differ from the best linear ones, a quarter of its height at least for a corner
    // of a bilinear patch.
    const int i = random.Integer(0, any.size_u() - 1), j = random.Integer(0, any.size_v() - 1);
    points(2, i * any.size_v() + j) = 1e-6;
    const NurbsSurface bent(any.basis_u(), any.basis_v(), points, any.weights());
    double height = 0;
    for (const double u : DenseParameters(any.basis_u(), 12)) {
      for (const double v : DenseParameters(any.basis_v(), 12)) {
        height = std::max(height, bent.At(u, v)[2]);
      }
    }
    constexpr double kFourTolerances = 4 * 2 * 1.7 * 1e-9;
    if (height < 2 * kFourTolerances) continue;
    EXPECT_NE(NameOf(ClassifyShape(bent)), "plane") << "height " << height;
  }
}

TEST(ClassifySurfaceShapeTest, OtherSurfacesAreFree) {
  RandomSplines random(10);
  for (int k = 0; k < 100; ++k) {
    const int p = random.Integer(1, 7), q = random.Integer(1, 7);
    SCOPED_TRACE(::testing::Message() << "seed 10, case " << k << ": degrees " << p << ", " << q);
    const NurbsSurface surface =
        random.Surface(p, q, random.Coin(), {.clamped = random.Coin(), .most_spans = 4});
    EXPECT_EQ(NameOf(ClassifyShape(surface)), "free");
    EXPECT_EQ(NameOf(ClassifyShape(random.Sheet(p, q, 1e-3))), "free");
  }
}

// One control point of a primitive moved by a small part of the size, or none by rounding.
TEST(ClassifySurfaceShapeTest, WhatIsNearlyAPrimitiveIsFree) {
  RandomSplines random(11);
  const NurbsSurface whole[] = {Sphere(1), Cylinder(1, 2), Cone(1, 2), Torus(2, 1)};
  const char* const names[] = {"sphere", "cylinder", "cone", "torus"};
  for (int k = 0; k < 200; ++k) {
    const NurbsSurface& surface = whole[k % 4];
    const Placement place(random);
    Eigen::Matrix3Xd points = surface.control_points();
    const Eigen::Vector3d way = random.Vector(1);
    const auto column = random.Integer(1, static_cast<int>(points.cols()) - 1);
    points.col(column) += random.Logarithmic(1e-6, 1e-2) * way;
    const NurbsSurface off(surface.basis_u(), surface.basis_v(), points, surface.weights());
    EXPECT_EQ(NameOf(ClassifyShape(place.Placed(off))), "free") << "seed 11, case " << k;
    EXPECT_EQ(NameOf(ClassifyShape(off, {.tolerance = 0.1})) == "free", false) << names[k % 4];
  }
}

TEST(ClassifySurfaceShapeTest, TurnedAndExtrudedFreeFormsAreSeen) {
  RandomSplines random(12);
  for (int k = 0; k < 100; ++k) {
    SCOPED_TRACE(::testing::Message() << "seed 12, case " << k);
    const NurbsCurve<2> profile =
        Shifted(random.Curve<2>(random.Integer(3, 6), random.Coin(), {.most_spans = 3}), 0.5, 2, 0);
    const Placement place(random);
    const SurfaceShape turned =
        ClassifyShape(place.Placed(RevolvedPatch(profile, 0, random.Real(0.5, 2.5))));
    ASSERT_EQ(NameOf(turned), "revolution");
    const auto& revolution = std::get<RevolutionShape>(turned);
    EXPECT_LT(revolution.axis.cross(place.turn.col(2)).norm(), kIterated);
    EXPECT_LT((revolution.point - place.shift).cross(revolution.axis).norm(),
              kIterated * place.scale);

    Eigen::Matrix3Xd points(3, 2 * profile.control_points().cols());
    Eigen::VectorXd weights(points.cols());
    const Eigen::Vector3d height(random.Real(-1, 1), random.Real(-1, 1), 1);
    for (Eigen::Index i = 0; i < profile.control_points().cols(); ++i) {
      points.col(2 * i) << profile.control_points().col(i), 0;
      points.col(2 * i + 1) = points.col(2 * i) + height;
      weights[2 * i] = weights[2 * i + 1] = profile.weights()[i];
    }
    const SurfaceShape pulled = ClassifyShape(
        place.Placed(NurbsSurface(profile.basis(), SplineBasis(1, {0, 0, 1, 1}), points, weights)));
    ASSERT_EQ(NameOf(pulled), "extrusion");
    EXPECT_LT(
        std::get<ExtrusionShape>(pulled).direction.cross(place.turn * height.normalized()).norm(),
        kIterated);
  }
}

// A surface that has shrunk to a curve or a point has no class.
TEST(ClassifySurfaceShapeTest, CollapsedSurfacesAreFree) {
  RandomSplines random(13);
  for (int k = 0; k < 100; ++k) {
    SCOPED_TRACE(::testing::Message() << "seed 13, case " << k);
    const NurbsSurface any = random.Surface(random.Integer(1, 5), random.Integer(1, 5), k % 2 == 0);
    Eigen::Matrix3Xd points = any.control_points();
    for (int i = 0; i < any.size_u(); ++i) {
      for (int j = 0; j < any.size_v(); ++j) {
        points.col(i * any.size_v() + j) = points.col(k % 4 < 2 ? i * any.size_v() : 0);
      }
    }
    // Products of one weight for a row and one for a column.
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(points.cols());
    for (Eigen::Index c = 0; c < weights.size() && k % 3 == 0; ++c) {
      weights[c] = any.weights()[c / any.size_v()] * any.weights()[c % any.size_v()];
    }
    const NurbsSurface collapsed(any.basis_u(), any.basis_v(), points, weights);
    EXPECT_EQ(NameOf(ClassifyShape(Placement(random).Placed(collapsed))), "free");
    points.row(2).setZero();
    const NurbsSurface flat(any.basis_u(), any.basis_v(), points, weights);
    EXPECT_EQ(NameOf(ClassifyShape(flat)), "free");
  }
}

// Seen about the axis of its normals, only the very corner lies outside what the inner places
// reach: too little for the profile of a torus.
TEST(ClassifySurfaceShapeTest, ASpikeIsFree) {
  const SplineBasis one(1, {0, 0, 1, 1});
  for (const double height : {1.0, 3.0, 10.0, 100.0}) {
    for (const double weight : {1.0, 0.1, 1e-2, 1e-3, 1e-4}) {
      Eigen::Matrix<double, 3, 4> points{{0, 0, 1, 1}, {0, 1, 0, 1}, {0, 0, 0, height}};
      const NurbsSurface spike(one, one, points, Eigen::Vector4d(1, 1, 1, weight));
      EXPECT_EQ(NameOf(ClassifyShape(spike)), "free") << height << ", weight " << weight;
    }
  }
}

// Many flat spans, and somewhere among them one ridge, which not every fit meets.
TEST(ClassifySurfaceShapeTest, OneBentSpanAmongManyFlatOnesIsSeen) {
  constexpr int kSpans = 40;
  std::vector<double> knots{0};
  for (int k = 0; k <= kSpans; ++k) knots.push_back(k);
  knots.push_back(kSpans);
  const SplineBasis many(1, knots), one(1, {0, 0, 1, 1});
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 2 * (kSpans + 1));
  for (int i = 0; i <= kSpans; ++i) {
    points.col(2 * i) << i, 0, 0;
    points.col(2 * i + 1) << i, 7, 0;
  }
  ASSERT_EQ(NameOf(ClassifyShape(NurbsSurface(many, one, points))), "plane");
  for (int i = 0; i <= kSpans; ++i) {
    Eigen::Matrix3Xd bent = points;
    bent(2, 2 * i) = 1;
    bent(2, 2 * i + 1) = 2;
    EXPECT_EQ(NameOf(ClassifyShape(NurbsSurface(many, one, bent))), "free") << "ridge at " << i;
  }
}

TEST(ClassifySurfaceShapeTest, TheToleranceIsPositive) {
  EXPECT_THROW(ClassifyShape(Sphere(1), {.tolerance = 0}), std::invalid_argument);
  EXPECT_THROW(ClassifyShape(Sphere(1), {.tolerance = NAN}), std::invalid_argument);
}

// exact_primitives.json: about the origin and the z axis.
TEST(ClassifySurfaceShapeTest, OraclePrimitives) {
  fixtures::CheckAll("exact_primitives.json", [](const auto& in, const auto& expected, double tol) {
    if (in.contains("radii")) return;
    const SurfaceShape shape = ClassifyShape(fixtures::Surface(expected.at("one_valid_nurbs")));
    ASSERT_EQ(NameOf(shape), std::string(in.at("kind")));
    const double first = in.at("parameters")[0];
    if (const auto* sphere = std::get_if<SphereShape>(&shape)) {
      fixtures::ExpectClose(sphere->radius, first, tol);
    } else if (const auto* cylinder = std::get_if<CylinderShape>(&shape)) {
      fixtures::ExpectClose(cylinder->radius, first, tol);
    } else if (const auto* torus = std::get_if<TorusShape>(&shape)) {
      fixtures::ExpectClose(torus->major_radius, first, tol);
      fixtures::ExpectClose(torus->minor_radius, in.at("parameters")[1], tol);
    } else {
      // Radius at z = 0, and the angle of the rulings to the axis.
      const auto& cone = std::get<ConeShape>(shape);
      const double angle = in.at("parameters")[1];
      fixtures::ExpectClose(cone.half_angle, angle, tol);
      fixtures::ExpectClose(cone.apex.norm(), first / std::tan(angle), tol);
    }
  });
}

TEST(LongClassifySurfaceShapeTest, PatchesOfPrimitivesAreRecognizedInEveryForm) {
  CheckPatches(14, 8000, 2e-3);
}

TEST(LongClassifySurfaceShapeTest, OtherSurfacesAreFree) {
  RandomSplines random(15);
  for (int k = 0; k < 1000; ++k) {
    const NurbsSurface surface =
        random.Surface(random.Integer(1, 11), random.Integer(1, 11), random.Coin());
    ASSERT_EQ(NameOf(ClassifyShape(surface)), "free") << "seed 15, case " << k;
  }
}

}  // namespace batten::internal::classify_surface_shape_test
