// SPDX-License-Identifier: MIT
#include "geometry/bezier/bezier_span.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "batten/geometry/nurbs_curve.h"
#include "geometry/nurbs/rational_derivatives.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::bezier_span_test {

void ForRandomSpans(const std::function<void(const SplineBasis&, int, RandomSplines&)>& law) {
  for (int degree = 1; degree <= 11; ++degree) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", seed " + std::to_string(seed));
      RandomSplines random(1000 * degree + seed);
      const SplineBasis basis = random.Basis(degree, {.clamped = seed % 2 == 0});
      for (const int span : basis.Spans()) law(basis, span, random);
      if (testing::Test::HasFailure()) return;
    }
  }
}

TEST(BezierSpanTest, RowsSumToOne) {
  ForRandomSpans([](const SplineBasis& basis, int span, RandomSplines&) {
    const Eigen::VectorXd sums = BezierSpanMatrix(basis, span).rowwise().sum();
    EXPECT_NEAR((sums.array() - 1).abs().maxCoeff(), 0, kRounding);
  });
}

TEST(BezierSpanTest, EntriesAreNotNegative) {
  ForRandomSpans([](const SplineBasis& basis, int span, RandomSplines&) {
    EXPECT_GE(BezierSpanMatrix(basis, span).minCoeff(), 0);
  });
}

TEST(BezierSpanTest, BezierPointsReproduceThePiece) {
  ForRandomSpans([](const SplineBasis& basis, int span, RandomSplines& random) {
    const int p = basis.degree();
    Eigen::Matrix2Xd points(2, basis.size());
    for (double& x : points.reshaped()) x = random.Real(-1, 1);
    const NurbsCurve<2> curve(basis, points);
    const Eigen::MatrixX2d bezier =
        BezierSpanMatrix(basis, span) * points.middleCols(span - p, p + 1).transpose();
    for (const double t : {0.0, 0.25, 0.6, 0.99}) {
      Eigen::Vector2d expected = Eigen::Vector2d::Zero();
      for (int j = 0; j <= p; ++j) {
        expected +=
            Binomial(p, j) * std::pow(t, j) * std::pow(1 - t, p - j) * bezier.row(j).transpose();
      }
      const double a = basis.knots()[span], b = basis.knots()[span + 1];
      EXPECT_NEAR((curve.At(a + t * (b - a)) - expected).norm(), 0, kRounding) << "t = " << t;
    }
  });
}

TEST(BezierSpanTest, IsTheIdentityOnABezierCurve) {
  for (int p = 1; p <= kMaxDegree; ++p) {
    const SplineBasis basis = SplineBasis::Uniform(p, p + 1, -3, 4);
    EXPECT_EQ(BezierSpanMatrix(basis, p), Eigen::MatrixXd::Identity(p + 1, p + 1))
        << "degree " << p;
  }
}

TEST(BezierSpanTest, NeighbouringPiecesShareTheirBezierPointAtTheKnot) {
  const SplineBasis basis = SplineBasis::Uniform(3, 9, 0, 1);
  const std::vector<int> spans = basis.Spans();
  for (size_t k = 1; k < spans.size(); ++k) {
    // The last Bézier point of a piece and the first of the next, in terms of all control points.
    Eigen::VectorXd last = Eigen::VectorXd::Zero(basis.size()), first = last;
    last.segment(spans[k - 1] - 3, 4) = BezierSpanMatrix(basis, spans[k - 1]).row(3).transpose();
    first.segment(spans[k] - 3, 4) = BezierSpanMatrix(basis, spans[k]).row(0).transpose();
    EXPECT_NEAR((last - first).norm(), 0, kRounding);
  }
}

}  // namespace batten::internal::bezier_span_test
