// SPDX-License-Identifier: MIT
#include "batten/geometry/nurbs_curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <string>

#include "exact_shapes.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten {
namespace {

// Calls law(curve, random) for curves of every degree up to 11, half of them rational with weights
// that differ by up to 10⁴, half of them unclamped.
template <int Dim, typename Law>
void ForRandomCurves(const Law& law, int highest_degree = 11) {
  for (int degree = 1; degree <= highest_degree; ++degree) {
    for (unsigned seed = 0; seed < 12; ++seed) {
      SCOPED_TRACE("dimension " + std::to_string(Dim) + ", degree " + std::to_string(degree) +
                   ", seed " + std::to_string(seed));
      RandomSplines random(1000 * degree + seed);
      law(random.Curve<Dim>(degree, seed % 2 == 0, {.clamped = seed % 4 < 2}), random);
      if (testing::Test::HasFailure()) return;
    }
  }
}

template <typename Dimension>
class NurbsCurveTest : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(NurbsCurveTest, Dimensions);

TYPED_TEST(NurbsCurveTest, MovesWithItsControlPointsUnderAffineMaps) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& curve, RandomSplines& random) {
    Eigen::Matrix<double, kDim, kDim> map;
    Eigen::Matrix<double, kDim, 1> shift;
    for (double& x : map.reshaped()) x = random.Real(-2, 2);
    for (double& x : shift) x = random.Real(-5, 5);
    const NurbsCurve<kDim> image(
        curve.basis(), (map * curve.control_points()).colwise() + shift, curve.weights());
    for (int trial = 0; trial < 5; ++trial) {
      const double u = random.Parameter(curve.basis());
      EXPECT_NEAR(
          (image.At(u) - (map * curve.At(u) + shift)).norm(), 0, kRounding * ExtentOf(image));
    }
  });
}

TYPED_TEST(NurbsCurveTest, LiesInTheHullOfItsActiveControlPoints) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& curve, RandomSplines& random) {
    for (int trial = 0; trial < 20; ++trial) {
      const double u = random.Parameter(curve.basis());
      const int p = curve.basis().degree(), first = curve.basis().Span(u) - p;
      const Eigen::Matrix<double, kDim, 1> direction = random.Vector(1).template head<kDim>();
      const Eigen::RowVectorXd heights =
          direction.transpose() * curve.control_points().middleCols(first, p + 1);
      const double height = direction.dot(curve.At(u));
      EXPECT_GE(height, heights.minCoeff() - kRounding);
      EXPECT_LE(height, heights.maxCoeff() + kRounding);
    }
  });
}

TYPED_TEST(NurbsCurveTest, StartsAndEndsInItsEndControlPointsWhenClamped) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& curve, RandomSplines&) {
    const SplineBasis& basis = curve.basis();
    const int p = basis.degree();
    if (basis.knots()[0] == basis.knots()[p]) {
      const Eigen::Matrix<double, kDim, 1> first = curve.control_points().col(0);
      EXPECT_NEAR((curve.At(basis.lower()) - first).norm(), 0, kRounding);
    }
    if (basis.knots().back() == basis.upper()) {
      const Eigen::Matrix<double, kDim, 1> last = curve.control_points().col(basis.size() - 1);
      EXPECT_NEAR((curve.At(basis.upper()) - last).norm(), 0, kRounding);
    }
  });
}

TYPED_TEST(NurbsCurveTest, DerivativeOfOrderZeroIsThePoint) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& curve, RandomSplines& random) {
    const double u = random.Parameter(curve.basis());
    EXPECT_NEAR((curve.Derivatives(u, 3).col(0) - curve.At(u)).norm(), 0, kRounding);
    EXPECT_EQ(curve.Derivatives(u, 0).cols(), 1);
  });
}

TYPED_TEST(NurbsCurveTest, DerivativesAreTheLimitsOfDifferences) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& curve, RandomSplines& random) {
    for (const int span : curve.basis().Spans()) {
      const double a = curve.basis().knots()[span], b = curve.basis().knots()[span + 1];
      const double u = a + random.Real(0.2, 0.8) * (b - a);
      const auto exact = curve.Derivatives(u, 4);
      // Richardson's extrapolation of central differences of the derivative one order lower.
      const double h = 2e-3 * (b - a);
      const auto plus = curve.Derivatives(u + h, 3), minus = curve.Derivatives(u - h, 3);
      const auto plus_half = curve.Derivatives(u + h / 2, 3);
      const auto minus_half = curve.Derivatives(u - h / 2, 3);
      const auto difference =
          ((4 * (plus_half - minus_half) / h - (plus - minus) / (2 * h)) / 3).eval();
      // Weights of 10⁴ bend the curve on a scale far below the span: the size of an order is the
      // largest of all orders up to the next but three, on the scale h of the differences times
      // 500.
      double size = 0;
      for (int k = 0; k <= 4; ++k) {
        size = std::max(size, exact.col(k).norm() * std::pow(b - a, k));
      }
      for (int k = 1; k <= 4; ++k) {
        EXPECT_NEAR((exact.col(k) - difference.col(k - 1)).norm() * std::pow(b - a, k),
                    0,
                    kHalfDigits * size)
            << "order " << k << " at " << u;
      }
    }
  });
}

TYPED_TEST(NurbsCurveTest, EqualWeightsAreNoWeights) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& curve, RandomSplines& random) {
    const NurbsCurve<kDim> plain(curve.basis(), curve.control_points());
    const NurbsCurve<kDim> equal(curve.basis(),
                                 curve.control_points(),
                                 Eigen::VectorXd::Constant(curve.basis().size(), 0.37));
    EXPECT_FALSE(plain.rational());
    EXPECT_FALSE(equal.rational());
    const double u = random.Parameter(curve.basis());
    const auto expected = plain.Derivatives(u, 3);
    EXPECT_NEAR((equal.Derivatives(u, 3) - expected).norm(), 0, kRounding * expected.norm());
  });
}

TYPED_TEST(NurbsCurveTest, WeightsTimesAConstantChangeNothing) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& curve, RandomSplines& random) {
    for (const double factor : {1e-9, 3.0, 1e9}) {
      const NurbsCurve<kDim> scaled(
          curve.basis(), curve.control_points(), factor * curve.weights());
      const double u = random.Parameter(curve.basis());
      EXPECT_NEAR((scaled.At(u) - curve.At(u)).norm(), 0, kRounding);
      const auto expected = curve.Derivatives(u, 2);
      EXPECT_NEAR((scaled.Derivatives(u, 2) - expected).norm(), 0, kIterated * expected.norm());
    }
  });
}

TYPED_TEST(NurbsCurveTest, ScalesWithItsControlPoints) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& curve, RandomSplines& random) {
    for (const double scale : {1e-9, 1e9}) {
      const NurbsCurve<kDim> scaled(curve.basis(), scale * curve.control_points(), curve.weights());
      const double u = random.Parameter(curve.basis());
      EXPECT_NEAR((scaled.At(u) / scale - curve.At(u)).norm(), 0, kRounding);
    }
  });
}

TYPED_TEST(NurbsCurveTest, TakesParametersOutsideTheDomainAtItsNearestEnd) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& curve, RandomSplines&) {
    const double lower = curve.basis().lower(), upper = curve.basis().upper();
    EXPECT_EQ(curve.At(lower - 3), curve.At(lower));
    EXPECT_EQ(curve.At(upper + 3), curve.At(upper));
    EXPECT_EQ(curve.Derivatives(lower - 3, 2), curve.Derivatives(lower, 2));
    EXPECT_EQ(curve.Derivatives(upper + 3, 2), curve.Derivatives(upper, 2));
  });
}

TYPED_TEST(NurbsCurveTest, OfDegreeOneWithTwoPointsIsTheirSegment) {
  constexpr int kDim = TypeParam::value;
  RandomSplines random(5);
  Eigen::Matrix<double, kDim, 2> ends;
  for (double& x : ends.reshaped()) x = random.Real(-1, 1);
  const NurbsCurve<kDim> segment(SplineBasis(1, {2, 2, 4, 4}), ends);
  for (const double t : {0.0, 0.25, 0.8, 1.0}) {
    const Eigen::Matrix<double, kDim, 1> expected = (1 - t) * ends.col(0) + t * ends.col(1);
    EXPECT_NEAR((segment.At(2 + 2 * t) - expected).norm(), 0, kRounding);
  }
  const auto derivatives = segment.Derivatives(3, 2);
  EXPECT_NEAR((derivatives.col(1) - (ends.col(1) - ends.col(0)) / 2).norm(), 0, kRounding);
  EXPECT_NEAR(derivatives.col(2).norm(), 0, kRounding);
}

TYPED_TEST(NurbsCurveTest, RefusesWhatDoesNotFitTogetherAndSaysWhat) {
  constexpr int kDim = TypeParam::value;
  using Points = Eigen::Matrix<double, kDim, Eigen::Dynamic>;
  const SplineBasis basis(2, {0, 0, 0, 1, 1, 1});
  const auto refusal = [&](const Points& points, const Eigen::VectorXd& weights) -> std::string {
    try {
      const NurbsCurve<kDim> curve(basis, points, weights);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  const Points good = Points::Ones(kDim, 3);
  const Eigen::Vector3d ones = Eigen::Vector3d::Ones();
  EXPECT_EQ(refusal(good, ones), "accepted");
  EXPECT_THAT(refusal(Points::Ones(kDim, 4), ones), testing::HasSubstr("4 control points"));
  EXPECT_THAT(refusal(Points(kDim, 0), {}), testing::HasSubstr("0 control points"));
  EXPECT_THAT(refusal(good, Eigen::Vector2d::Ones()), testing::HasSubstr("2 weights"));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Points points = good;
    points(kDim - 1, 2) = bad;
    EXPECT_THAT(refusal(points, ones), testing::HasSubstr("control point is not finite"));
    EXPECT_THAT(refusal(good, Eigen::Vector3d(1, bad, 1)),
                testing::HasSubstr("not positive and finite"));
  }
  EXPECT_THAT(refusal(good, Eigen::Vector3d(1, 0, 1)),
              testing::HasSubstr("not positive and finite"));
  EXPECT_THAT(refusal(good, Eigen::Vector3d(1, 1, -1)),
              testing::HasSubstr("not positive and finite"));
}

TYPED_TEST(NurbsCurveTest, RefusesANegativeOrder) {
  constexpr int kDim = TypeParam::value;
  RandomSplines random(1);
  EXPECT_THROW(random.Curve<kDim>(3, false).Derivatives(0, -1), std::invalid_argument);
}

TYPED_TEST(NurbsCurveTest, EqualMeansSameBasisPointsAndWeights) {
  constexpr int kDim = TypeParam::value;
  RandomSplines random(1), again(1), other(2);
  const NurbsCurve<kDim> curve = random.Curve<kDim>(3, true);
  EXPECT_EQ(curve, again.Curve<kDim>(3, true));
  EXPECT_NE(curve, NurbsCurve<kDim>(curve.basis(), curve.control_points()));
}

TEST(ExactConicTest, CircleOfNinePointsHasItsRadiusToRounding) {
  RandomSplines random(9);
  for (const double radius : {1e-9, 1.0, 123.4, 1e9}) {
    const NurbsCurve<2> circle = Circle(radius);
    EXPECT_TRUE(circle.rational());
    for (int trial = 0; trial < 200; ++trial) {
      const auto d = circle.Derivatives(random.Real(0, 1), 1);
      EXPECT_NEAR(d.col(0).norm() / radius, 1, kRounding);
      EXPECT_NEAR(d.col(0).dot(d.col(1)) / (d.col(0).norm() * d.col(1).norm()), 0, kRounding);
    }
  }
}

}  // namespace
}  // namespace batten
