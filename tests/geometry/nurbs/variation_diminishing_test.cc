// SPDX-License-Identifier: MIT
// No line meets a planar curve more often than it meets the control polygon, and no plane a space
// curve: the curve wiggles no more than its polygon. [Schoenberg 1967; Piegl & Tiller 1997, P3.9]
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "extended_evaluation.h"
#include "law_cases.h"

namespace batten::internal::variation_diminishing_test {

// How often the heights change sign, those within rounding of zero left out; cyclic if closed.
template <typename Heights>
int Crossings(const Heights& heights, double rounding, bool closed) {
  int crossings = 0;
  double first = 0, last = 0;
  for (const double height : heights) {
    if (std::abs(height) <= rounding) continue;
    if (first == 0) first = height;
    if (last * height < 0) ++crossings;
    last = height;
  }
  return crossings + (closed && first * last < 0 ? 1 : 0);
}

// The hyperplane direction·x = offset.
template <int Dim>
struct Plane {
  Eigen::Matrix<double, Dim, 1> direction;
  double offset;
};

// Random ones; those through points of the curve, which touch or cross it there; those through
// control points.
template <int Dim>
Plane<Dim> RandomPlane(const NurbsCurve<Dim>& curve, RandomSplines& random) {
  Plane<Dim> plane;
  const auto on_it = [&](const Eigen::VectorXd& a) { plane.offset = plane.direction.dot(a); };
  plane.direction = random.Vector(1).template head<Dim>().normalized();
  const auto& points = curve.control_points();
  const Eigen::Index i = random.Integer(0, static_cast<int>(points.cols()) - 1);
  switch (random.Integer(0, 3)) {
    case 0:
      plane.offset = random.Real(-1, 1);
      break;
    case 1:
      on_it(curve.At(random.Parameter(curve.basis())));
      break;
    case 2:
      on_it(points.col(i));
      break;
    default:  // along the tangent
      const CurveJet<Dim> jet = curve.JetAt(random.Parameter(curve.basis()));
      const double length = jet.first.squaredNorm();
      if (length > 0) plane.direction -= plane.direction.dot(jet.first) / length * jet.first;
      if (plane.direction.norm() > 0) plane.direction.normalize();
      on_it(jet.point);
      break;
  }
  return plane;
}

template <int Dim>
void WigglesNoMoreThanItsPolygon() {
  ForRandomCurves<Dim>(
      [](const NurbsCurve<Dim>& curve, RandomSplines& random) {
        const SplineBasis& basis = curve.basis();
        const int p = basis.degree(), n = basis.size();
        const double rounding = Dim * (14 * p + 12) * kEpsilon;
        std::vector<double> parameters(1, basis.upper());
        for (const int span : basis.Spans()) {
          const double a = basis.knots()[span], b = basis.knots()[span + 1];
          for (int k = 0; k < 60; ++k) parameters.push_back(a + (b - a) * k / 60);
        }
        std::sort(parameters.begin(), parameters.end());
        Eigen::Matrix<double, Dim, Eigen::Dynamic> samples(Dim, parameters.size());
        for (size_t k = 0; k < parameters.size(); ++k) samples.col(k) = curve.At(parameters[k]);
        for (int trial = 0; trial < 30; ++trial) {
          const Plane<Dim> plane = RandomPlane(curve, random);
          const auto heights = [&](const auto& points) -> Eigen::RowVectorXd {
            return (plane.direction.transpose() * points).array() - plane.offset;
          };
          // A periodic curve and its polygon are closed: the repeated control points do not count.
          const bool closed = basis.periodic();
          const int polygon =
              Crossings(heights(curve.control_points().leftCols(closed ? n - p : n)), 0, closed);
          EXPECT_LE(Crossings(heights(samples), rounding, closed), polygon);
          // The piece of one span against the polygon of its own control points.
          const int span = AnyOf(basis.Spans(), random);
          const auto low =
              std::lower_bound(parameters.begin(), parameters.end(), basis.knots()[span]);
          const auto high = std::upper_bound(low, parameters.end(), basis.knots()[span + 1]);
          const auto piece = samples.middleCols(low - parameters.begin(), high - low);
          EXPECT_LE(
              Crossings(heights(piece), rounding, false),
              Crossings(heights(curve.control_points().middleCols(span - p, p + 1)), 0, false));
        }
      },
      8);
}

TEST(VariationDiminishingTest, LinesMeetAPlanarCurveNoMoreOftenThanItsPolygon) {
  WigglesNoMoreThanItsPolygon<2>();
}

TEST(VariationDiminishingTest, PlanesMeetASpaceCurveNoMoreOftenThanItsPolygon) {
  WigglesNoMoreThanItsPolygon<3>();
}

// The extreme case: a polygon that zigzags across the line, of which the curve keeps what it can.
TEST(VariationDiminishingTest, AZigzagIsMetNoMoreOftenThanItChangesSides) {
  for (int degree = 1; degree <= kHighestDegree; ++degree) {
    SCOPED_TRACE("degree " + std::to_string(degree));
    RandomSplines random(degree);
    const SplineBasis basis = SplineBasis::Uniform(degree, 4 * degree + 3, 0, 1);
    Eigen::Matrix2Xd points(2, basis.size());
    for (int i = 0; i < basis.size(); ++i) {
      points.col(i) << i, (i % 2 == 0 ? 1 : -1) * random.Real(0.1, 1);
    }
    const NurbsCurve<2> curve(basis, points, random.Weights(basis.size()));
    std::vector<double> heights;
    for (int k = 0; k <= 5000; ++k) heights.push_back(curve.At(k / 5000.0).y());
    EXPECT_LE(Crossings(heights, 0, false), basis.size() - 1);
    EXPECT_GT(Crossings(heights, 0, false), degree == 1 ? basis.size() - 2 : 0);
  }
}

// Over an affine map of a convex polygon the curve is convex: no line meets it three times.
TEST(VariationDiminishingTest, AConvexPolygonGivesAConvexCurve) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = 1 + static_cast<int>(seed) % kHighestDegree;
    const SplineBasis basis = random.Basis(degree, {.clamped = random.Coin()});
    Eigen::Matrix2Xd points(2, basis.size());
    for (int i = 0; i < basis.size(); ++i) {
      const double angle = 3 * (i + random.Real(0, 0.9)) / basis.size();
      points.col(i) << std::cos(angle), std::sin(angle);
    }
    const NurbsCurve<2> curve(basis, points, random.Weights(basis.size()));
    for (int trial = 0; trial < 50; ++trial) {
      const double u = random.Parameter(basis);
      const Eigen::Matrix2Xd d = curve.Derivatives(u, 2);
      const Sized exact = ExtendedCurve(curve, u, 2, Eigen::Vector2d::Zero());
      const double turn = d(0, 1) * d(1, 2) - d(1, 1) * d(0, 2);
      const double size = static_cast<double>(exact.size.col(1).norm() * exact.size.col(2).norm());
      EXPECT_GE(turn, -6 * (7 * degree + 6) * kEpsilon * size);  // never to the right
    }
  }
}

}  // namespace batten::internal::variation_diminishing_test
