// SPDX-License-Identifier: MIT
#include "batten/geometry/intersect_curves.h"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/split.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::intersect_curves_test {

constexpr double kTolerance = 1e-9;

std::vector<Eigen::Vector2d> Polyline(const NurbsCurve<2>& curve, int count) {
  std::vector<Eigen::Vector2d> points;
  const double lower = curve.basis().lower(), upper = curve.basis().upper();
  for (int k = 0; k <= count; ++k) points.push_back(curve.At(lower + k * (upper - lower) / count));
  return points;
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a[0] * b[1] - a[1] * b[0];
}

// Every crossing of two dense polylines has a meeting of the curves beside it.
TEST(IntersectCurvesTest, NoCrossingOfRandomPlaneCurvesIsMissed) {
  int crossings = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const auto a = random.Curve<2>(random.Integer(1, 5), random.Coin());
    const auto b = random.Curve<2>(random.Integer(1, 5), random.Coin());
    const CurveIntersection<2> met = IntersectCurves(a, b, kTolerance);
    for (const CurveMeeting<2>& one : met.points) {
      EXPECT_LE((a.At(one.first) - b.At(one.second)).norm(), 2 * kTolerance);
    }
    const auto x = Polyline(a, 800), y = Polyline(b, 800);
    for (std::size_t i = 1; i < x.size(); ++i) {
      for (std::size_t j = 1; j < y.size(); ++j) {
        const Eigen::Vector2d r = x[i] - x[i - 1], s = y[j] - y[j - 1], d = y[j - 1] - x[i - 1];
        const double det = Cross(r, s);
        if (std::abs(det) < 0.05 * r.norm() * s.norm()) continue;
        const double t = Cross(d, s) / det, u = Cross(d, r) / det;
        if (t < 0 || t > 1 || u < 0 || u > 1) continue;
        ++crossings;
        const Eigen::Vector2d at = x[i - 1] + t * r;
        const double near = 4 * (r.norm() + s.norm());
        EXPECT_TRUE(std::any_of(met.points.begin(), met.points.end(), [&](const auto& one) {
          return (one.point - at).norm() <= near;
        })) << at.transpose();
      }
    }
  }
  EXPECT_GT(crossings, 100);
}

TEST(IntersectCurvesTest, TouchingCirclesAreOneTangentialPoint) {
  const auto a = MakeArc(Eigen::Vector2d(0, 0), 1.0), b = MakeArc(Eigen::Vector2d(1.5, 0), 0.5);
  const CurveIntersection<2> met = IntersectCurves(a, b, kTolerance);
  ASSERT_EQ(met.points.size(), 1u);
  EXPECT_TRUE(met.points[0].tangential);
  EXPECT_LE((met.points[0].point - Eigen::Vector2d(1, 0)).norm(), std::sqrt(kTolerance));
  EXPECT_TRUE(met.overlaps.empty());
}

TEST(IntersectCurvesTest, PartsOfOneCurveOverlapWhereTheyShareIt) {
  RandomSplines random(3);
  const auto whole = random.Curve<3>(3, true, {.most_spans = 6});
  const double lower = whole.basis().lower(), width = whole.basis().upper() - lower;
  const auto a = Segment(whole, lower, lower + 0.6 * width);
  const auto b = Segment(whole, lower + 0.3 * width, lower + width);
  const CurveIntersection<3> met = IntersectCurves(a, b, kTolerance);
  ASSERT_EQ(met.overlaps.size(), 1u);
  EXPECT_NEAR(met.overlaps[0].first.lower, lower + 0.3 * width, 1e-6);
  EXPECT_NEAR(met.overlaps[0].first.upper, lower + 0.6 * width, 1e-6);
}

TEST(IntersectCurvesTest, ALineMeetsACircleTwiceAndTouchesItOnce) {
  const auto circle = MakeArc(Eigen::Vector2d(0, 0), 1.0);
  const auto twice = IntersectLine<2>(circle, {-5, 0.5}, {2, 0}, kTolerance);
  ASSERT_EQ(twice.points.size(), 2u);
  EXPECT_NEAR(twice.points[0].second + twice.points[1].second, 10, 1e-8);
  const auto touch = IntersectLine<2>(circle, {-5, 1}, {2, 0}, kTolerance);
  ASSERT_EQ(touch.points.size(), 1u);
  EXPECT_TRUE(touch.points[0].tangential);
  EXPECT_TRUE(IntersectLine<2>(circle, {-5, 1.1}, {2, 0}, kTolerance).points.empty());
  EXPECT_THROW(IntersectLine<2>(circle, {0, 0}, {0, 0}, kTolerance), std::invalid_argument);
}

TEST(IntersectCurvesTest, ACurveInSpaceMeetsASurfaceOnBoth) {
  const NurbsSurface sphere = MakeSphere({}, 1.2);
  const auto circle = MakeArc(Frame({0, 0, 1}, {0, 1, 0}), 1.0);
  const auto met = IntersectCurveSurface(circle, sphere, kTolerance);
  ASSERT_EQ(met.points.size(), 2u);
  for (const CurveSurfaceMeeting& one : met.points) {
    EXPECT_NEAR(one.point.norm(), 1.2, kTolerance);
    EXPECT_NEAR(one.point[2], 0.72, kTolerance);
  }
  const auto touch = IntersectCurveSurface(circle, MakePlane({}, {-2, 2}, {-2, 2}), kTolerance);
  ASSERT_EQ(touch.points.size(), 1u);
  EXPECT_TRUE(touch.points[0].tangential);
}

TEST(IntersectCurvesTest, AnIsoCurveOverlapsItsSurfaceAllAlong) {
  RandomSplines random(5);
  const NurbsSurface sheet = random.Sheet(3, 3, 0.5, {.most_spans = 5});
  const SplineBasis& v = sheet.basis_v();
  Eigen::Matrix3Xd points(3, v.size());
  for (int j = 0; j < v.size(); ++j) points.col(j) = sheet.control_point(0, j);
  const auto met = IntersectCurveSurface(NurbsCurve<3>(v, points), sheet, 1e-7);
  ASSERT_EQ(met.overlaps.size(), 1u);
  EXPECT_TRUE(met.points.empty());
  EXPECT_EQ(met.overlaps[0].on_curve.lower, v.lower());
  EXPECT_EQ(met.overlaps[0].on_curve.upper, v.upper());
}

// The two roots of a line and a sphere, near a pole and at it, whatever the distance from it.
TEST(IntersectCurvesTest, ALineNearAPoleMeetsTheSphereTwice) {
  RandomSplines random(17);
  for (int k = 0; k < 120; ++k) {
    SCOPED_TRACE(k);
    const Eigen::Vector3d centre = random.Vector(3);
    const double radius = random.Real(0.5, 20), off = k % 6 == 0 ? 0 : std::pow(10, -(k % 12) - 2);
    const NurbsSurface sphere = MakeSphere(Frame(centre, random.Vector(1)), radius);
    const Eigen::Vector3d pole =
        sphere.At(sphere.basis_u().lower(),
                  random.Coin() ? sphere.basis_v().lower() : sphere.basis_v().upper());
    const Eigen::Vector3d outward = (pole - centre) / radius;
    const Eigen::Vector3d place = pole + radius * off * random.Vector(1);
    Eigen::Vector3d along = random.Vector(1).normalized();
    if (k % 4 == 0) along = outward;
    if (std::abs(along.dot(outward)) < 0.2) along = (along + outward).normalized();
    const double length = 5 * radius;
    const NurbsCurve<3> line = MakeLine<3>(place - length * along, place + length * along);
    const auto met = IntersectCurveSurface(line, sphere, kTolerance * radius);
    ASSERT_EQ(met.points.size(), 2u);
    EXPECT_TRUE(met.overlaps.empty());
    const double middle = (centre - place).dot(along);
    const double half =
        std::sqrt(radius * radius - (place + middle * along - centre).squaredNorm());
    for (const int side : {0, 1}) {
      const double root = middle + (side == 0 ? -half : half);
      EXPECT_LE((met.points[side].point - place - root * along).norm(), 8 * kTolerance * radius);
      EXPECT_FALSE(met.points[side].tangential);
    }
  }
}

TEST(IntersectCurvesTest, ALineInThePlaneOfAPoleTouchesThere) {
  const NurbsSurface sphere = MakeSphere({}, 1);
  const auto met = IntersectCurveSurface(MakeLine<3>({-2, 0.3, 1}, {2, -0.3, 1}), sphere, 1e-9);
  ASSERT_EQ(met.points.size(), 1u);
  EXPECT_TRUE(met.points[0].tangential);
}

}  // namespace batten::internal::intersect_curves_test
