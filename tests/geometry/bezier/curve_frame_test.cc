// SPDX-License-Identifier: MIT
#include "geometry/bezier/curve_frame.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "batten/geometry/curvature.h"
#include "exact_shapes.h"
#include "fixtures.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::curve_frame_test {

// The Bézier curve of these control points on [0, 1].
template <int Dim>
NurbsCurve<Dim> Bezier(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                       const Eigen::VectorXd& weights = {}) {
  const int degree = static_cast<int>(points.cols()) - 1;
  return NurbsCurve<Dim>(SplineBasis::Uniform(degree, degree + 1, 0, 1), points, weights);
}

template <int Dim>
NurbsCurve<Dim> RandomCurve(RandomSplines& random) {
  const bool clamped = random.Coin(), periodic = random.Integer(0, 2) == 0;
  return random.Curve<Dim>(random.Integer(2, 8),
                           random.Coin(),
                           {.clamped = clamped, .most_spans = 3, .periodic = periodic});
}

template <int Dim>
NurbsCurve<Dim> Reversed(const NurbsCurve<Dim>& curve) {
  std::vector<double> knots(curve.basis().knots().rbegin(), curve.basis().knots().rend());
  for (double& u : knots) u = -u;
  return NurbsCurve<Dim>(SplineBasis(curve.basis().degree(), knots),
                         curve.control_points().rowwise().reverse(),
                         curve.weights().reverse());
}

TEST(CurveFrameTest, OfACircleLooksToItsCentre) {
  for (const double r : {1e-9, 1.0, 1e9}) {
    const NurbsCurve<2> circle = Circle(r);
    for (const double u : {0.0, 0.1, 0.25, 0.6, 1.0}) {
      const auto frame = FrameAt(circle, u);
      ASSERT_TRUE(frame);
      const Eigen::Vector2d out = circle.At(u) / r;
      EXPECT_NEAR((frame->normal.head<2>() + out).norm(), 0, kRounding);
      EXPECT_NEAR((frame->tangent - Eigen::Vector3d(-out.y(), out.x(), 0)).norm(), 0, kRounding);
      EXPECT_NEAR((frame->binormal - Eigen::Vector3d::UnitZ()).norm(), 0, kRounding);
      EXPECT_NEAR(*SignedCurvatureAt(circle, u) * r, 1, kRounding);
      EXPECT_NEAR(*SignedCurvatureAt(Reversed(circle), -u) * r, -1, kRounding);
    }
  }
}

TEST(CurveFrameTest, IsARightHandedFrameThatTurnsWithTheCurve) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<3> curve = RandomCurve<3>(random);
    const double u = random.Parameter(curve.basis());
    const auto frame = FrameAt(curve, u);
    if (!frame) continue;  // one period of few knots may hold a point or a line
    Eigen::Matrix3d axes;
    axes << frame->tangent, frame->normal, frame->binormal;
    EXPECT_NEAR((axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm(), 0, kRounding);
    EXPECT_NEAR(axes.determinant(), 1, kRounding);
    EXPECT_NEAR((*TangentAt(curve, u) - frame->tangent).norm(), 0, kRounding);
    const Eigen::AngleAxisd turn(random.Real(0, 6), random.Vector(1).normalized());
    const NurbsCurve<3> turned(
        curve.basis(), turn.toRotationMatrix() * curve.control_points(), curve.weights());
    const auto other = FrameAt(turned, u);
    ASSERT_TRUE(other);
    EXPECT_NEAR((other->tangent - turn * frame->tangent).norm(), 0, kIterated);
    const Eigen::Matrix3Xd C = curve.Derivatives(u, 2);
    const double sine = C.col(1).cross(C.col(2)).norm() / (C.col(1).norm() * C.col(2).norm());
    if (sine > 1e-3) {
      EXPECT_NEAR((other->normal - turn * frame->normal).norm(), 0, kIterated);
      EXPECT_GT(frame->normal.dot(C.col(2)), 0);
    }
  }
}

TEST(CurveFrameTest, ObeysFrenetsFormulas) {
  // T′ = κ N, B′ = −τ N with respect to arc length, against differences inside a span.
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<3> curve = random.Curve<3>(random.Integer(3, 6), false, {.most_spans = 1});
    const double lower = curve.basis().lower(), width = curve.basis().upper() - lower;
    const double u = lower + random.Real(0.1, 0.9) * width, h = 1e-5 * width;
    const auto here = FrameAt(curve, u), before = FrameAt(curve, u - h),
               after = FrameAt(curve, u + h);
    const auto k = CurvatureAt(curve, u);
    ASSERT_TRUE(here && before && after && k);
    const double step = 2 * h * curve.Derivatives(u, 1).col(1).norm();
    if (k->curvature * width > 50 || std::abs(k->torsion) * width > 50) continue;  // near a cusp
    const Eigen::Vector3d turn = (after->tangent - before->tangent) / step;
    const Eigen::Vector3d twist = (after->binormal - before->binormal) / step;
    const double size = 1 + k->curvature + std::abs(k->torsion);
    EXPECT_NEAR((turn - k->curvature * here->normal).norm(), 0, kHalfDigits * size * size * size);
    EXPECT_NEAR((twist + k->torsion * here->normal).norm(), 0, kHalfDigits * size * size * size);
  }
}

TEST(CurveFrameTest, TangentsAtCoincidentEndPointsAreLimits) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(2, 9), coincident = random.Integer(2, degree);
    const NurbsCurve<3> whole = random.Curve<3>(degree, random.Coin(), {.most_spans = 3});
    Eigen::Matrix3Xd points = whole.control_points();
    const Eigen::Index n = points.cols();
    for (int i = 1; i < coincident; ++i) {
      points.col(i) = points.col(0);
      points.col(n - 1 - i) = points.col(n - 1);
    }
    for (const double far : {0.0, 1e9}) {
      if (2 * coincident > n) break;
      const NurbsCurve<3> curve(
          whole.basis(), points.colwise() + Eigen::Vector3d(far, -far, far), whole.weights());
      const Eigen::Vector3d first =
          curve.control_points().col(coincident) - curve.control_points().col(0);
      const Eigen::Vector3d last =
          curve.control_points().col(n - 1) - curve.control_points().col(n - 1 - coincident);
      const auto start = TangentAt(curve, curve.basis().lower());
      const auto end = TangentAt(curve, curve.basis().upper());
      ASSERT_TRUE(start && end) << "far " << far << " degree " << degree << " coincident "
                                << coincident << ' ' << !!start << !!end;
      const double rounding = far == 0 ? kIterated : kHalfDigits * 10;
      EXPECT_NEAR((*start - first.normalized()).norm(), 0, rounding);
      EXPECT_NEAR((*end - last.normalized()).norm(), 0, rounding);
      // A hair beside the ends too.
      const double hair = 1e-13 * (curve.basis().upper() - curve.basis().lower());
      EXPECT_NEAR((*TangentAt(curve, curve.basis().lower() + hair) - first.normalized()).norm(),
                  0,
                  kHalfDigits * 10);
      EXPECT_NEAR((*TangentAt(curve, curve.basis().upper() - hair) - last.normalized()).norm(),
                  0,
                  kHalfDigits * 10);
    }
  }
}

TEST(CurveFrameTest, CurvatureAtASlowStartIsTheLimitOrNone) {
  // The parabola (s, s²) run through as s = t²: C′ vanishes at 0, the curvature is 2 there.
  const Eigen::Matrix2Xd slow{{0, 0, 1.0 / 6, 0.5, 1}, {0, 0, 0, 0, 1}};
  const auto at_start = CurvatureAt(Bezier<2>(slow), 0);
  ASSERT_TRUE(at_start);
  EXPECT_NEAR(at_start->curvature, 2, kIterated);
  EXPECT_NEAR(*SignedCurvatureAt(Bezier<2>(slow), 0), 2, kIterated);
  EXPECT_NEAR(*SignedCurvatureAt(Reversed(Bezier<2>(slow)), 0), -2, kIterated);
  // (t², t³): the cusp has tangent and normal but no finite curvature.
  const NurbsCurve<2> cusp = Bezier<2>(Eigen::Matrix2Xd{{0, 0, 1.0 / 3, 1}, {0, 0, 0, 1}});
  EXPECT_FALSE(CurvatureAt(cusp, 0));
  EXPECT_FALSE(SignedCurvatureAt(cusp, 0));
  const auto frame = FrameAt(cusp, 0);
  ASSERT_TRUE(frame);
  EXPECT_NEAR((frame->tangent - Eigen::Vector3d::UnitX()).norm(), 0, kRounding);
  EXPECT_NEAR((frame->normal - Eigen::Vector3d::UnitY()).norm(), 0, kRounding);
  // (t², t⁴, t⁶) is the twisted cubic at half speed: κ = 2, τ = 3 at its start.
  Eigen::Matrix3Xd twisted = Eigen::Matrix3Xd::Zero(3, 7);
  const double square[7] = {0, 0, 1, 3, 6, 10, 15}, fourth[7] = {0, 0, 0, 0, 1, 5, 15};
  for (int i = 0; i < 7; ++i) twisted.col(i) << square[i] / 15, fourth[i] / 15, i == 6;
  const auto k = CurvatureAt(Bezier<3>(twisted), 0);
  ASSERT_TRUE(k);
  EXPECT_NEAR(k->curvature, 2, kIterated);
  EXPECT_NEAR(k->torsion, 3, kIterated);
}

TEST(CurveFrameTest, AtAnInflectionIsTheLimit) {
  // (t, t³, t⁴) at 0: no curvature, the frame of what follows, torsion 2.
  const auto blossom = [](int power, int i) {  // Bézier ordinates of t^power in degree 4
    double value = 1;
    for (int k = 0; k < power; ++k) value *= static_cast<double>(i - k) / (4 - k);
    return value;
  };
  Eigen::Matrix3Xd points(3, 5);
  for (int i = 0; i < 5; ++i) points.col(i) << blossom(1, i), blossom(3, i), blossom(4, i);
  const NurbsCurve<3> curve = Bezier<3>(points);
  const auto k = CurvatureAt(curve, 0);
  ASSERT_TRUE(k);
  EXPECT_EQ(k->curvature, 0);
  EXPECT_NEAR(k->torsion, 2, kIterated);
  const auto frame = FrameAt(curve, 0);
  ASSERT_TRUE(frame);
  EXPECT_NEAR((frame->normal - Eigen::Vector3d::UnitY()).norm(), 0, kRounding);
  EXPECT_NEAR((frame->binormal - Eigen::Vector3d::UnitZ()).norm(), 0, kRounding);
}

TEST(CurveFrameTest, OfAStraightLineHasATangentOnly) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(1, 7);
    const Eigen::Vector3d a = random.Vector(1), b = random.Vector(1);
    Eigen::Matrix3Xd points(3, degree + 1);
    for (int i = 0; i <= degree; ++i) points.col(i) = a + (b - a) * i / degree;
    const NurbsCurve<3> line = Bezier<3>(points, random.Weights(degree + 1));
    for (const double u : {0.0, 0.3, 1.0}) {
      const auto tangent = TangentAt(line, u);
      ASSERT_TRUE(tangent);
      EXPECT_NEAR((*tangent - (b - a).normalized()).norm(), 0, kIterated);
      EXPECT_FALSE(FrameAt(line, u));
      const auto k = CurvatureAt(line, u);
      ASSERT_TRUE(k);
      EXPECT_EQ(k->curvature, 0);
      EXPECT_EQ(k->torsion, 0);
    }
  }
}

TEST(CurveFrameTest, OfAPointIsNothing) {
  const NurbsCurve<3> point =
      Bezier<3>(Eigen::Vector3d(1, 2, 3).replicate(1, 4), Eigen::Vector4d(1, 2, 0.3, 4));
  EXPECT_FALSE(TangentAt(point, 0.5));
  EXPECT_FALSE(FrameAt(point, 0));
  EXPECT_FALSE(CurvatureAt(point, 1));
}

TEST(CurveFrameTest, CurvatureDoesNotDependOnTheParameter) {
  // A linear rational change of parameter multiplies Bézier weights by powers of a constant.
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(2, 6);
    const NurbsCurve<3> curve = random.Curve<3>(degree, true, {.most_spans = 1});
    const double c = random.Real(0.5, 2);
    Eigen::VectorXd weights = curve.weights();
    for (int i = 0; i <= degree; ++i) weights[i] *= std::pow(c, i);
    const NurbsCurve<3> other = Bezier<3>(curve.control_points(), weights);
    const double t = random.Real(0, 1), lower = curve.basis().lower();
    const double s = c * t / (1 - t + c * t);
    const auto a = CurvatureAt(curve, lower + (curve.basis().upper() - lower) * s);
    const auto b = CurvatureAt(other, t);
    ASSERT_TRUE(a && b);
    EXPECT_NEAR(a->curvature / b->curvature, 1, kHalfDigits);
    EXPECT_NEAR(a->torsion, b->torsion, kHalfDigits * (1 + std::abs(a->torsion)));
  }
}

TEST(CurveFrameFixturesTest, CurvaturesAgreeWithOtherImplementations) {
  using namespace fixtures;
  int seen = 0;
  const auto check = [](const auto& curve, double u, const Json& expected, double tolerance) {
    const auto k = CurvatureAt(curve, u);
    ASSERT_TRUE(k);
    ExpectClose(k->curvature, expected.at("curvature"), tolerance);
    if (!expected.at("torsion").is_null()) {
      ExpectClose(k->torsion, expected.at("torsion"), tolerance);
    }
  };
  CheckAll("measures_curvature.json",
           [&](const Json& input, const Json& expected, double tolerance) {
             if (!expected.contains("torsion")) return;
             ++seen;
             if (InPlane(input.at("curve"))) {
               check(Curve<2>(input.at("curve")), input.at("u"), expected, tolerance);
             } else {
               check(Curve<3>(input.at("curve")), input.at("u"), expected, tolerance);
             }
           });
  EXPECT_EQ(seen, 16);
}

}  // namespace batten::internal::curve_frame_test
