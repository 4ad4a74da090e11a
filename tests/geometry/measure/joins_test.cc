// SPDX-License-Identifier: MIT
#include "batten/geometry/joins.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/split.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::joins_test {

using ::testing::HasSubstr;

// Well inside a span, so that both parts are of a size to compare.
double InsideASpan(const SplineBasis& basis, RandomSplines& random) {
  const std::vector<int> spans = basis.Spans();
  const int span = spans[random.Integer(0, static_cast<int>(spans.size()) - 1)];
  const double a = basis.knots()[span], b = basis.knots()[span + 1];
  return a + random.Real(0.3, 0.7) * (b - a);
}

template <int Dim>
NurbsCurve<Dim> MildCurve(int degree, bool rational, RandomSplines& random) {
  const NurbsCurve<Dim> curve =
      random.Curve<Dim>(degree, false, {.most_spans = 3, .highest_multiplicity = 1});
  if (!rational) return curve;
  return NurbsCurve<Dim>(
      curve.basis(), curve.control_points(), random.Weights(curve.basis().size(), 0.3, 3));
}

NurbsSurface MildSurface(int degree_u, int degree_v, bool rational, RandomSplines& random) {
  const NurbsSurface sheet =
      random.Sheet(degree_u, degree_v, 0.7, {.most_spans = 3, .highest_multiplicity = 1});
  if (!rational) return sheet;
  return NurbsSurface(sheet.basis_u(),
                      sheet.basis_v(),
                      sheet.control_points(),
                      random.Weights(sheet.control_points().cols(), 0.3, 3));
}

template <int Dim>
NurbsCurve<Dim> Scaled(const NurbsCurve<Dim>& curve, double scale) {
  return NurbsCurve<Dim>(curve.basis(), scale * curve.control_points(), curve.weights());
}

NurbsSurface Scaled(const NurbsSurface& surface, double scale) {
  return NurbsSurface(
      surface.basis_u(), surface.basis_v(), scale * surface.control_points(), surface.weights());
}

// The patch over [x0, x1] × [y0, y1] of the plane through the y axis that rises by `slope` along x.
NurbsSurface Flat(double x0, double x1, double y0, double y1, double slope = 0) {
  Eigen::Matrix3Xd points(3, 4);
  points << x0, x0, x1, x1, y0, y1, y0, y1, slope * x0, slope * x0, slope * x1, slope * x1;
  const SplineBasis basis(1, {0, 0, 1, 1});
  return NurbsSurface(basis, basis, points);
}

// With the parameter a + 2 t / (1 + t/10) in place of a + t.
template <typename Shape, typename... Way>
Shape OtherSpeed(const Shape& shape, double a, Way... way) {
  constexpr double kBend = 0.1;
  return MobiusReparameterized(
      shape, way..., kBend * a + 2, -a - kBend * a * a, kBend, 1 - kBend * a);
}

template <int Dim>
void CheckPartsOfCurves(int degree, RandomSplines& random) {
  const NurbsCurve<Dim> whole =
      Scaled(MildCurve<Dim>(degree, random.Coin(), random), random.Logarithmic(1e-9, 1e9));
  auto [first, second] = Split(whole, InsideASpan(whole.basis(), random));
  const bool turned_1 = random.Coin(), turned_2 = random.Coin();
  if (turned_1) first = Reversed(first);
  if (turned_2) second = Reversed(second);
  const CurveJoin join = TestJoin(first, second);
  EXPECT_EQ(join.parametric, 2);
  EXPECT_EQ(join.geometric, 2);
  EXPECT_EQ(join.at[0], turned_1 ? first.basis().lower() : first.basis().upper());
  EXPECT_EQ(join.at[1], turned_2 ? second.basis().upper() : second.basis().lower());
  const double size = SizeOf(whole);
  EXPECT_LT(join.position_gap, kRounding * size);
  EXPECT_LT(join.angle_gap.value(), kIterated);
  // Other speeds leave only the shape smooth.
  const double a = second.basis().lower(), b = second.basis().upper();
  const CurveJoin faster = TestJoin(first, Reparameterized(second, a, a + 0.7 * (b - a)));
  EXPECT_EQ(faster.parametric, 0);
  EXPECT_EQ(faster.geometric, 2);
  const CurveJoin other = TestJoin(first, OtherSpeed(second, a));
  EXPECT_LE(other.parametric, 1);
  EXPECT_EQ(other.geometric, 2);
}

TEST(JoinsTest, PartsOfOneCurveMeetSmoothly) {
  RandomSplines random(1);
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(::testing::Message() << "seed 1, case " << k);
    const int degree = random.Integer(2, 7);
    if (random.Coin()) {
      CheckPartsOfCurves<2>(degree, random);
    } else {
      CheckPartsOfCurves<3>(degree, random);
    }
  }
}

// Split at a knot of multiplicity m, a curve with other control points to either side is C^(p − m).
TEST(JoinsTest, KnotsLimitTheContinuity) {
  RandomSplines random(2);
  for (int k = 0; k < 300; ++k) {
    const int degree = random.Integer(1, 5), multiplicity = random.Integer(1, degree);
    SCOPED_TRACE(::testing::Message() << "seed 2, case " << k << ": degree " << degree
                                      << ", multiplicity " << multiplicity);
    std::vector<double> knots(degree + 1, 0.0);
    knots.insert(knots.end(), multiplicity, random.Real(0.3, 0.7));
    knots.insert(knots.end(), degree + 1, 1.0);
    Eigen::Matrix3Xd points(3, degree + 1 + multiplicity);
    for (double& x : points.reshaped()) x = random.Real(-1, 1);
    const NurbsCurve<3> whole(SplineBasis(degree, knots), points);
    const auto [first, second] = Split(whole, knots[degree + 1]);
    const CurveJoin join = TestJoin(first, second);
    EXPECT_EQ(join.parametric, std::min(2, degree - multiplicity));
    EXPECT_EQ(join.geometric, std::min(2, degree - multiplicity));
  }
}

NurbsCurve<2> LineTo(double x, double y) {
  Eigen::Matrix2d points{{x - 1, x}, {y, y}};
  return NurbsCurve<2>(SplineBasis(1, {0, 0, 1, 1}), points);
}

TEST(JoinsTest, GapsOfCurvesAreMeasured) {
  for (const double angle : {1e-3, 0.5, 3.0}) {
    const Eigen::Matrix2d points{{0, std::cos(angle)}, {0, std::sin(angle)}};
    const NurbsCurve<2> bent(SplineBasis(1, {0, 0, 1, 1}), points);
    const CurveJoin join = TestJoin(LineTo(0, 0), bent);
    EXPECT_NEAR(join.angle_gap.value(), angle, kRounding);
    EXPECT_EQ(join.geometric, 0);
    EXPECT_EQ(join.parametric, 0);
    EXPECT_EQ(TestJoin(LineTo(0, 0), bent, {.angle_tolerance = 3.1}).geometric, 2);
  }
  // A line that goes on as a circle of radius 2, and how it does if it ends a little before.
  const NurbsCurve<2> circle = Circle(2);
  Eigen::Matrix2Xd turned(2, 9);
  turned << -circle.control_points().row(1), circle.control_points().row(0);
  const NurbsCurve<2> up(
      circle.basis(), turned.colwise() - Eigen::Vector2d(0, 2), circle.weights());
  const NurbsCurve<2> arc = Reversed(Split(up, 0.25).first);
  for (const double gap : {0.0, 1e-6}) {
    const CurveJoin join = TestJoin(LineTo(0, gap), up);
    EXPECT_NEAR(join.position_gap, gap, kRounding);
    EXPECT_EQ(join.geometric, gap == 0 ? 0 : -1) << "the circle runs the other way";
    EXPECT_NEAR(join.angle_gap.value(), std::numbers::pi, kRounding);
    EXPECT_NEAR(join.curvature_gap.value(), 0.5, kRounding);
  }
  Eigen::Matrix2d forth{{0, 1}, {0, 0}};
  const CurveJoin smooth = TestJoin(NurbsCurve<2>(SplineBasis(1, {0, 0, 1, 1}), forth), arc);
  EXPECT_EQ(smooth.geometric, 1);
  EXPECT_NEAR(smooth.curvature_gap.value(), 0.5, kRounding);
  EXPECT_EQ(TestJoin(LineTo(0, 1e-6), LineTo(1, 0), {.position_tolerance = 1e-5}).parametric, 2);
}

TEST(JoinsTest, SeamsOfCurves) {
  const CurveJoin circle = TestSeam(Circle(3));
  EXPECT_EQ(circle.geometric, 2);
  EXPECT_EQ(circle.parametric, 1);  // rational quadratic arcs
  EXPECT_EQ(circle.at[0], 1);
  EXPECT_EQ(circle.at[1], 0);
  EXPECT_EQ(TestSeam(LineTo(0, 0)).geometric, -1);
  EXPECT_EQ(TestSeam(LineTo(0, 0)).position_gap, 1);
  RandomSplines random(3);
  for (int k = 0; k < 200; ++k) {
    const int degree = random.Integer(1, 5);
    const NurbsCurve<3> curve = random.Curve<3>(
        degree, false, {.most_spans = 5, .highest_multiplicity = 1, .periodic = true});
    if (curve.basis().size() - degree < degree + 3) continue;
    const CurveJoin seam = TestSeam(curve);
    EXPECT_EQ(seam.parametric, std::min(2, degree - 1)) << "seed 3, case " << k;
    EXPECT_EQ(seam.geometric, std::min(2, degree - 1)) << "seed 3, case " << k;
  }
}

// Where the first derivative vanishes the tangent is that of the second.
TEST(JoinsTest, CoincidentEndPointsHaveATangent) {
  const Eigen::Matrix<double, 2, 4> points{{0, 1, 2, 2}, {1, 0, 0, 0}};
  const NurbsCurve<2> curve(SplineBasis(3, {0, 0, 0, 0, 1, 1, 1, 1}), points);
  const CurveJoin join = TestJoin(curve, LineTo(3, 0));
  EXPECT_EQ(join.at[0], 1);
  EXPECT_NEAR(join.angle_gap.value(), 0, kRounding);
  EXPECT_GE(join.geometric, 1);
  EXPECT_EQ(join.parametric, 0);
}

TEST(JoinsTest, PartsOfOneSurfaceMeetSmoothly) {
  RandomSplines random(4);
  for (int k = 0; k < 60; ++k) {
    SCOPED_TRACE(::testing::Message() << "seed 4, case " << k);
    const NurbsSurface whole =
        Scaled(MildSurface(random.Integer(2, 5), random.Integer(2, 5), random.Coin(), random),
               random.Logarithmic(1e-9, 1e9));
    const Direction cut = random.Coin() ? Direction::kU : Direction::kV;
    const SplineBasis& basis = cut == Direction::kU ? whole.basis_u() : whole.basis_v();
    auto [first, second] = Split(whole, cut, InsideASpan(basis, random));
    SurfaceEdge edges[2] = {{cut, true}, {cut, false}};
    int odd = 0;
    NurbsSurface* const parts[2] = {&first, &second};
    for (int p = 0; p < 2; ++p) {
      for (const Direction direction : {Direction::kU, Direction::kV}) {
        if (random.Coin()) continue;
        *parts[p] = Reversed(*parts[p], direction);
        if (direction == cut) {
          edges[p].upper = !edges[p].upper;
        } else {
          ++odd;
        }
      }
      if (random.Coin()) {
        *parts[p] = Swapped(*parts[p]);
        edges[p].direction = edges[p].direction == Direction::kU ? Direction::kV : Direction::kU;
      }
    }
    const SurfaceJoin join = TestJoin(first, second);
    EXPECT_EQ(join.parametric, 2);
    EXPECT_EQ(join.geometric, 2);
    EXPECT_EQ(join.shared_edges, 1);
    EXPECT_EQ(join.edges[0], edges[0]);
    EXPECT_EQ(join.edges[1], edges[1]);
    EXPECT_EQ(join.reversed, odd % 2 == 1);
    EXPECT_LT(join.position_gap, kIterated * SizeOf(whole));
    EXPECT_LT(
        (first.At(join.at[0][0], join.at[0][1]) - second.At(join.at[1][0], join.at[1][1])).norm(),
        kIterated * SizeOf(whole));
    // Another speed along the edge.
    const Direction along = edges[1].direction == Direction::kU ? Direction::kV : Direction::kU;
    const SplineBasis& b = along == Direction::kU ? second.basis_u() : second.basis_v();
    const double a = b.lower();
    const SurfaceJoin other = TestJoin(first, OtherSpeed(second, a, along));
    EXPECT_EQ(other.parametric, 0);
    EXPECT_EQ(other.geometric, 2);
  }
}

TEST(JoinsTest, KnotsLimitTheContinuityOfSurfaces) {
  RandomSplines random(5);
  for (int k = 0; k < 40; ++k) {
    const int degree = random.Integer(1, 4), multiplicity = random.Integer(1, degree);
    SCOPED_TRACE(::testing::Message() << "seed 5, case " << k << ": degree " << degree
                                      << ", multiplicity " << multiplicity);
    std::vector<double> knots(degree + 1, 0.0);
    knots.insert(knots.end(), multiplicity, 0.4);
    knots.insert(knots.end(), degree + 1, 1.0);
    const SplineBasis across(degree, knots), along = random.Basis(random.Integer(1, 4));
    Eigen::Matrix3Xd points(3, across.size() * along.size());
    for (int i = 0; i < across.size(); ++i) {
      for (int j = 0; j < along.size(); ++j) {
        points.col(i * along.size() + j) << i + random.Real(-0.2, 0.2), j + random.Real(-0.2, 0.2),
            random.Real(-1, 1);
      }
    }
    const auto [first, second] = Split(NurbsSurface(across, along, points), Direction::kU, 0.4);
    const SurfaceJoin join = TestJoin(first, second);
    EXPECT_EQ(join.parametric, std::min(2, degree - multiplicity));
    EXPECT_EQ(join.geometric, std::min(2, degree - multiplicity));
  }
}

TEST(JoinsTest, GapsOfSurfacesAreMeasured) {
  // Planes that meet at the y axis at an angle, and one that lies on the other.
  for (const double angle : {1e-3, 0.5, 1.5}) {
    const SurfaceJoin join = TestJoin(Flat(-1, 0, 0, 1), Flat(0, 1, 0, 1, std::tan(angle)));
    EXPECT_NEAR(join.angle_gap.value(), angle, kRounding);
    EXPECT_EQ(join.geometric, 0);
    EXPECT_EQ(join.parametric, 0);
  }
  const SurfaceJoin folded = TestJoin(Flat(0, 1, 0, 1), Flat(0, 2, 0, 1));
  EXPECT_NEAR(folded.angle_gap.value(), std::numbers::pi, kRounding);
  EXPECT_EQ(folded.geometric, 0);
  EXPECT_EQ(TestJoin(Flat(-1, 0, 0, 1), Flat(0, 1, 0, 1)).parametric, 2);
  EXPECT_EQ(TestJoin(Flat(-1, 0, 0, 1), Flat(0, 2, 0, 1)).parametric, 0);
  EXPECT_EQ(TestJoin(Flat(-1, 0, 0, 1), Flat(0, 2, 0, 1)).geometric, 2);
  // A gap.
  const SurfaceJoin apart = TestJoin(Flat(-1, 0, 0, 1), Flat(1e-5, 1, 0, 1));
  EXPECT_NEAR(apart.position_gap, 1e-5, kRounding);
  EXPECT_EQ(apart.geometric, -1);
  EXPECT_EQ(apart.parametric, -1);
  EXPECT_EQ(apart.shared_edges, 0);
  EXPECT_EQ(apart.edges[0], (SurfaceEdge{Direction::kU, true}));
  EXPECT_EQ(
      TestJoin(Flat(-1, 0, 0, 1), Flat(1e-5, 1, 0, 1), {.position_tolerance = 1e-4}).geometric, 2);
  // Only a corner in common.
  EXPECT_EQ(TestJoin(Flat(-1, 0, 0, 1), Flat(0, 1, 1, 2)).geometric, -1);
  // A quarter of a cylinder that goes on as a plane, whose normal curvature it has along the edge
  // only.
  constexpr double kRadius = 4;
  const NurbsSurface quarter = Split(Cylinder(kRadius, 3), Direction::kU, 0.25).first;
  Eigen::Matrix3Xd plane(3, 4);
  plane << kRadius, kRadius, kRadius, kRadius, 0, 0, -1, -1, 0, 3, 0, 3;
  const SplineBasis basis(1, {0, 0, 1, 1});
  const SurfaceJoin tangent = TestJoin(quarter, NurbsSurface(basis, basis, plane));
  EXPECT_EQ(tangent.geometric, 1);
  EXPECT_NEAR(tangent.angle_gap.value(), 0, kIterated);
  EXPECT_NEAR(tangent.curvature_gap.value(), 1 / kRadius, kIterated);
}

TEST(JoinsTest, HalvesOfPrimitives) {
  const auto [left, right] = Split(Cylinder(2, 3), Direction::kU, 0.5);
  const SurfaceJoin tube = TestJoin(left, right);
  EXPECT_EQ(tube.shared_edges, 2);
  EXPECT_EQ(tube.geometric, 2);
  const auto [west, east] = Split(Sphere(1), Direction::kU, 0.5);  // two poles each
  EXPECT_EQ(TestJoin(west, east).geometric, 2);
  const auto [south, north] = Split(Sphere(1), Direction::kV, 0.5);
  const SurfaceJoin equator = TestJoin(south, north);
  EXPECT_EQ(equator.shared_edges, 1);
  EXPECT_EQ(equator.geometric, 2);
}

TEST(JoinsTest, SeamsOfSurfaces) {
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    const SurfaceJoin seam = TestSeam(Torus(3, 1), direction);
    EXPECT_EQ(seam.geometric, 2);
    EXPECT_EQ(seam.parametric, 1);
  }
  EXPECT_EQ(TestSeam(Sphere(1), Direction::kU).geometric, 2);
  EXPECT_EQ(TestSeam(Cylinder(2, 3), Direction::kV).geometric, -1);
  EXPECT_NEAR(TestSeam(Cylinder(2, 3), Direction::kV).position_gap, 3, kRounding);
}

TEST(JoinsTest, EdgesThatCoincideInPartAreRefused) {
  const auto expect_refused = [](const NurbsSurface& a, const NurbsSurface& b) {
    try {
      TestJoin(a, b);
      ADD_FAILURE() << "accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr("over a part only"));
      EXPECT_THAT(error.what(), HasSubstr("u = 1 of the first"));
      EXPECT_THAT(error.what(), HasSubstr("u = 0 of the second"));
    }
  };
  expect_refused(Flat(-1, 0, 0, 1), Flat(0, 1, 0.5, 1.5));    // each beyond the other
  expect_refused(Flat(-1, 0, 0, 1), Flat(0, 1, 0.49, 0.51));  // one inside the other
  expect_refused(Flat(-1, 0, 0, 0.01), Flat(0, 1, -1, 1));
}

TEST(JoinsTest, TolerancesAreChecked) {
  const NurbsSurface flat = Flat(0, 1, 0, 1);
  EXPECT_THROW(TestJoin(flat, flat, {.position_tolerance = 0}), std::invalid_argument);
  EXPECT_THROW(TestJoin(flat, flat, {.angle_tolerance = -1}), std::invalid_argument);
  EXPECT_THROW(TestSeam(Circle(1), {.curvature_tolerance = NAN}), std::invalid_argument);
  EXPECT_THROW(TestSeam(flat, Direction::kU, {.derivative_tolerance = 0}), std::invalid_argument);
}

}  // namespace batten::internal::joins_test
