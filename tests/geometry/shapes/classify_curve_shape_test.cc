// SPDX-License-Identifier: MIT
#include "batten/geometry/classify_shape.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>

#include "geometry/nurbs/homogeneous.h"
#include "exact_shapes.h"
#include "fixtures.h"
#include "random_splines.h"
#include "shape_cases.h"
#include "tolerances.h"

namespace batten::internal::classify_curve_shape_test {

template <int Dim>
NurbsCurve<Dim> Richer(const NurbsCurve<Dim>& curve, int by, RandomSplines& random) {
  const SplineBasis basis = Richer(curve.basis(), by, random);
  return CurveFromHomogeneous<Dim>(
      basis, Converted(curve.basis(), Homogeneous(curve), basis), curve.rational());
}

NurbsCurve<3> InSpace(const NurbsCurve<2>& curve) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, curve.control_points().cols());
  points.topRows<2>() = curve.control_points();
  return NurbsCurve<3>(curve.basis(), points, curve.weights());
}

// Other weights by a linear rational change of the parameter of a one-span curve: w_i · c^i.
template <int Dim>
NurbsCurve<Dim> Moebius(const NurbsCurve<Dim>& curve, double c) {
  Eigen::VectorXd weights = curve.weights();
  for (Eigen::Index i = 0; i < weights.size(); ++i) weights[i] *= std::pow(c, i);
  return NurbsCurve<Dim>(curve.basis(), curve.control_points(), weights);
}

TEST(ClassifyCurveShapeTest, AnyFormOfALineIsALine) {
  RandomSplines random(1);
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(::testing::Message() << "seed 1, case " << k);
    const int degree = random.Integer(1, 11);
    const bool periodic = random.Integer(0, 3) == 0;
    const NurbsCurve<3> any =
        random.Curve<3>(degree, random.Coin(), {.clamped = random.Coin(), .periodic = periodic});
    if (periodic && any.basis().size() == degree + 1) continue;  // a point
    const Eigen::Vector3d start = random.Vector(3), direction = random.Vector(1).normalized();
    Eigen::Matrix3Xd points = direction * any.control_points().row(0);
    points.colwise() += start;
    const Placement place(random);
    const CurveShape shape =
        ClassifyShape(place.Placed(NurbsCurve<3>(any.basis(), points, any.weights())));
    ASSERT_EQ(NameOf(shape), "line");
    const auto& line = std::get<LineShape>(shape);
    EXPECT_LT(line.direction.cross(place.turn * direction).norm(), 100 * kRounding);
    EXPECT_LT((line.point - place.Point(start)).cross(line.direction).norm(),
              100 * kRounding * place.scale);
  }
}

TEST(ClassifyCurveShapeTest, ArcsAreCirclesInEveryForm) {
  RandomSplines random(2);
  for (int k = 0; k < 500; ++k) {
    const double sweep = random.Logarithmic(1e-3, 3);
    NurbsCurve<3> curve = InSpace(CircleArc(random.Real(0, 6), sweep));
    curve = Moebius(curve, random.Logarithmic(0.1, 10));
    const int by = random.Integer(0, 6);
    if (by > 0) curve = Richer(curve, by, random);
    const Placement place(random);
    SCOPED_TRACE(::testing::Message()
                 << "seed 2, case " << k << ": sweep " << sweep << ", elevated by " << by);
    const CurveShape shape = ClassifyShape(place.Placed(curve));
    ASSERT_EQ(NameOf(shape), "circle");
    const auto& circle = std::get<CircleShape>(shape);
    // Radius and centre follow from the sagitta, sweep² / 8 of the radius.
    const double relative = 100 * kRounding / (sweep * sweep);
    EXPECT_NEAR(circle.radius, place.scale, relative * place.scale);
    EXPECT_LT((circle.center - place.Point(Eigen::Vector3d::Zero())).norm(),
              relative * place.scale);
    EXPECT_LT(circle.normal.cross(place.turn.col(2)).norm(), relative);
  }
}

TEST(ClassifyCurveShapeTest, CirclesOfThePlaneHaveTheirCentreRadiusAndSense) {
  const CurveShape shape = ClassifyShape(Shifted(Circle(2), 1, 3, -5));
  ASSERT_EQ(NameOf(shape), "circle");
  const auto& circle = std::get<CircleShape>(shape);
  EXPECT_NEAR(circle.radius, 2, kRounding);
  EXPECT_LT((circle.center - Eigen::Vector3d(3, -5, 0)).norm(), kRounding);
  EXPECT_LT((circle.normal - Eigen::Vector3d(0, 0, 1)).norm(), kRounding);  // runs to the left
}

// The 9-point circle over a periodic basis that begins inside an arc.
TEST(ClassifyCurveShapeTest, ThePeriodicCircleIsACircle) {
  const SplineBasis basis =
      SplineBasis::Periodic(2, {-0.25, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1.25, 1.25});
  const NurbsCurve<2> circle = Circle(3);
  Eigen::Matrix2Xd points(2, basis.size());
  Eigen::VectorXd weights(basis.size());
  for (int i = 0; i < basis.size(); ++i) {
    const int j = i % 8;
    points.col(i) = circle.control_points().col(j);
    weights[i] = circle.weights()[j];
  }
  EXPECT_EQ(NameOf(ClassifyShape(NurbsCurve<2>(basis, points, weights))), "circle");
}

TEST(ClassifyCurveShapeTest, QuadraticBezierCurvesAreWhatTheirShapeFactorSays) {
  RandomSplines random(3);
  int seen[3] = {0, 0, 0};
  for (int k = 0; k < 1000; ++k) {
    NurbsCurve<2> plane = random.Curve<2>(2, true, {.most_spans = 1});
    Eigen::VectorXd w = plane.weights();
    if (random.Integer(0, 2) == 0) w[1] = std::sqrt(w[0] * w[2]);
    plane = NurbsCurve<2>(plane.basis(), plane.control_points(), w);
    const Placement place(random);
    NurbsCurve<3> curve = InSpace(plane);
    if (random.Coin()) curve = Richer(curve, random.Integer(1, 4), random);
    static const char* const kNames[] = {"ellipse", "parabola", "hyperbola"};
    const auto expected = static_cast<int>(ClassifyConic(w[0], w[1], w[2]));
    EXPECT_EQ(NameOf(ClassifyShape(place.Placed(curve))), kNames[expected])
        << "seed 3, case " << k << ": k = " << ConicShapeFactor(w[0], w[1], w[2]);
    ++seen[expected];
  }
  for (const int count : seen) EXPECT_GT(count, 100);
}

// Every point of a conic keeps the law of its foci.
TEST(ClassifyCurveShapeTest, PointsKeepTheLawOfTheFoci) {
  RandomSplines random(4);
  for (int k = 0; k < 600; ++k) {
    SCOPED_TRACE(::testing::Message() << "seed 4, case " << k);
    NurbsCurve<2> plane = random.Curve<2>(2, false, {.most_spans = 1});
    plane = NurbsCurve<2>(plane.basis(),
                          plane.control_points(),
                          Eigen::Vector3d(1, k % 3 == 0 ? 1 : random.Logarithmic(0.2, 5), 1));
    const Placement place(random);
    const NurbsCurve<3> curve = place.Placed(InSpace(plane));
    const CurveShape shape = ClassifyShape(curve);
    for (const double u : {0.0, 0.3, 0.7, 1.0}) {
      const Eigen::Vector3d p = curve.At(u);
      if (const auto* parabola = std::get_if<ParabolaShape>(&shape)) {
        const double f = parabola->focal_length, along = (p - parabola->vertex).dot(parabola->axis);
        const double to_focus = (p - parabola->vertex - f * parabola->axis).norm();
        EXPECT_NEAR(to_focus, along + f, kIterated * (to_focus + place.scale));
      } else if (const auto* ellipse = std::get_if<EllipseShape>(&shape)) {
        const double a = ellipse->major_radius, b = ellipse->minor_radius;
        ASSERT_GE(a, b);
        EXPECT_LT(std::abs(ellipse->major_axis.dot(ellipse->minor_axis)), kRounding);
        const Eigen::Vector3d focus = std::sqrt((a - b) * (a + b)) * ellipse->major_axis;
        const Eigen::Vector3d from = p - ellipse->center;
        EXPECT_NEAR((from - focus).norm() + (from + focus).norm(), 2 * a, kIterated * a);
      } else if (const auto* hyperbola = std::get_if<HyperbolaShape>(&shape)) {
        const double a = hyperbola->transverse_radius, b = hyperbola->conjugate_radius;
        EXPECT_LT(std::abs(hyperbola->transverse_axis.dot(hyperbola->conjugate_axis)), kRounding);
        const Eigen::Vector3d focus = std::hypot(a, b) * hyperbola->transverse_axis;
        const Eigen::Vector3d from = p - hyperbola->center;
        EXPECT_NEAR((from + focus).norm() - (from - focus).norm(),
                    2 * a,
                    kIterated * (from.norm() + a + b));
      } else {
        ADD_FAILURE() << NameOf(shape);
      }
    }
  }
}

TEST(ClassifyCurveShapeTest, OtherCurvesAreFree) {
  RandomSplines random(5);
  for (int k = 0; k < 1000; ++k) {
    const int degree = random.Integer(2, 11);
    const bool periodic = random.Integer(0, 3) == 0;
    const BasisKind kind{.clamped = random.Coin(), .periodic = periodic};
    const bool rational = random.Coin();
    SCOPED_TRACE(::testing::Message() << "seed 5, case " << k << ": degree " << degree);
    const NurbsCurve<2> plane = random.Curve<2>(degree, rational, kind);
    const int distinct = plane.basis().size() - (periodic ? degree : 0);
    if (distinct > 3) {
      EXPECT_EQ(NameOf(ClassifyShape(plane)), "free");
    }
    const NurbsCurve<3> space = random.Curve<3>(degree, rational, kind);
    if (space.basis().size() - (periodic ? degree : 0) > 3) {
      EXPECT_EQ(NameOf(ClassifyShape(space)), "free");
    }
  }
}

TEST(ClassifyCurveShapeTest, BrokenLinesAndPointsAreFree) {
  const SplineBasis two(1, {0, 0, 1, 2, 2});
  for (const double bend : {1.0, 1e-3, 1e-6, 1e-7}) {
    Eigen::Matrix<double, 2, 3> points{{-1, 0, 1}, {0, bend, 0}};
    EXPECT_EQ(NameOf(ClassifyShape(NurbsCurve<2>(two, points))), "free") << bend;
  }
  const Eigen::Matrix<double, 2, 3> there_and_back{{0, 1, 0}, {0, 2, 0}};
  EXPECT_EQ(NameOf(ClassifyShape(NurbsCurve<2>(two, there_and_back))), "line");
  const Eigen::Matrix<double, 3, 3> point = Eigen::Vector3d(1, 2, 3).replicate<1, 3>();
  EXPECT_EQ(NameOf(ClassifyShape(NurbsCurve<3>(two, point))), "free");
  EXPECT_EQ(NameOf(ClassifyShape(NurbsCurve<3>(two, Eigen::Matrix3d::Zero()))), "free");
}

// A control point of weight one in a million moves the curve only where weights are small: the
// checking samples find the place.
TEST(ClassifyCurveShapeTest, ALightControlPointOffTheLineIsSeen) {
  Eigen::Matrix<double, 2, 4> points{{0, 1, 2, 3}, {0, 0, 1, 0}};
  const NurbsCurve<2> curve(
      SplineBasis(3, {0, 0, 0, 0, 1, 1, 1, 1}), points, Eigen::Vector4d(1e6, 1e6, 1, 1e6));
  const double off = curve.At(0.5)[1];
  ASSERT_GT(off, 1e-7);
  EXPECT_EQ(NameOf(ClassifyShape(curve)), "free");
  EXPECT_EQ(NameOf(ClassifyShape(curve, {.tolerance = 1e-6})), "line");
}

// A circle with one control point moved by a little is none; with one moved by less than the
// tolerance it still is.
TEST(ClassifyCurveShapeTest, WhatIsNearlyACircleIsOneWithinTheToleranceOnly) {
  RandomSplines random(6);
  for (int k = 0; k < 200; ++k) {
    const NurbsCurve<2> circle = Circle(random.Logarithmic(1e-9, 1e9));
    const double size = ExtentOf(circle), moved = size * random.Logarithmic(1e-7, 1e-2);
    Eigen::Matrix2Xd points = circle.control_points();
    points.col(random.Integer(1, 7)) += moved * Eigen::Vector2d(random.Real(-1, 1), 1);
    const NurbsCurve<2> off(circle.basis(), points, circle.weights());
    EXPECT_EQ(NameOf(ClassifyShape(off)), "free") << "seed 6, case " << k;
    EXPECT_EQ(NameOf(ClassifyShape(off, {.tolerance = moved / size})), "circle") << k;
  }
}

TEST(ClassifyCurveShapeTest, TheConicOfBezierWeights) {
  EXPECT_EQ(ClassifyConic(1, 1, 1), ConicKind::kParabola);
  EXPECT_EQ(ClassifyConic(1, 0.5, 1), ConicKind::kEllipse);
  EXPECT_EQ(ClassifyConic(1, -0.5, 1), ConicKind::kEllipse);
  EXPECT_EQ(ClassifyConic(1, 2, 1), ConicKind::kHyperbola);
  EXPECT_EQ(ClassifyConic(0.1, 0.3, 0.9), ConicKind::kParabola);
  EXPECT_EQ(ClassifyConic(1, 1.01, 1, 0.1), ConicKind::kParabola);
  EXPECT_DOUBLE_EQ(ConicShapeFactor(2, 3, 4), 8.0 / 9);
  EXPECT_THROW(ClassifyConic(1, 0, 1), std::invalid_argument);
  EXPECT_THROW(ClassifyConic(1, 1, -1), std::invalid_argument);
  EXPECT_THROW(ClassifyConic(1, 1, 1, -1), std::invalid_argument);
  EXPECT_THROW(ClassifyShape(Circle(1), {.tolerance = 0}), std::invalid_argument);
}

// exact_primitives.json: about the origin.
TEST(ClassifyCurveShapeTest, OracleConics) {
  fixtures::CheckAll("exact_primitives.json", [](const auto& in, const auto& expected, double tol) {
    if (!in.contains("radii")) return;
    const CurveShape shape = ClassifyShape(fixtures::Curve<3>(expected.at("one_valid_nurbs")));
    ASSERT_EQ(NameOf(shape), std::string(in.at("kind")));
    const double a = in.at("radii")[0], b = in.at("radii")[1];
    if (const auto* circle = std::get_if<CircleShape>(&shape)) {
      fixtures::ExpectClose(circle->radius, a, tol);
      EXPECT_LT(circle->center.norm(), tol * a);
    } else {
      const auto& ellipse = std::get<EllipseShape>(shape);
      fixtures::ExpectClose(ellipse.major_radius, a, tol);
      fixtures::ExpectClose(ellipse.minor_radius, b, tol);
      EXPECT_LT(ellipse.center.norm(), tol * a);
    }
  });
}

}  // namespace batten::internal::classify_curve_shape_test
