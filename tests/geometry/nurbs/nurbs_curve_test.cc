// SPDX-License-Identifier: MIT
#include "batten/geometry/nurbs_curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <string>

#include "exact_shapes.h"
#include "extended_evaluation.h"
#include "law_cases.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::nurbs_curve_test {

// The sum of a curve's terms is taken about one of the first or last control points of the span.
template <int Dim>
Eigen::VectorXd Origin(const NurbsCurve<Dim>& curve, double u) {
  const int span = curve.basis().Span(u);
  const double low = curve.basis().knots()[span], high = curve.basis().knots()[span + 1];
  return curve.control_points().col(u - low > high - u ? span : span - curve.basis().degree());
}

// The largest range of a coordinate over the control points of a span.
template <int Dim>
double Range(const NurbsCurve<Dim>& curve, int span) {
  const int p = curve.basis().degree();
  const auto active = curve.control_points().middleCols(span - p, p + 1);
  return (active.rowwise().maxCoeff() - active.rowwise().minCoeff()).maxCoeff();
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

TYPED_TEST(NurbsCurveTest, StartsAndEndsInItsEndControlPointsWhenClamped) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& curve, RandomSplines&) {
    const SplineBasis& basis = curve.basis();
    const int p = basis.degree();
    if (basis.knots()[0] == basis.knots()[p]) {
      const Eigen::Matrix<double, kDim, 1> first = curve.control_points().col(0);
      EXPECT_EQ(curve.At(basis.lower()), first);
    }
    if (basis.knots().back() == basis.upper()) {
      const Eigen::Matrix<double, kDim, 1> last = curve.control_points().col(basis.size() - 1);
      EXPECT_EQ(curve.At(basis.upper()), last);
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

// Header: (7p + 3)·ε·D + ε·|C|. Far from the origin D does not grow.
TYPED_TEST(NurbsCurveTest, PointsAreRightToTheirBound) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& near, RandomSplines& random) {
    for (const double distance : {0.0, 1e3, 1e9}) {
      const NurbsCurve<kDim> curve(
          near.basis(), (near.control_points().array() + distance).matrix(), near.weights());
      const double u = random.Parameter(curve.basis());
      const int p = curve.basis().degree(), span = curve.basis().Span(u);
      const Eigen::VectorXd origin = Origin(curve, u), point = curve.At(u);
      const Sized exact = ExtendedCurve(curve, u, 0, origin);
      for (int x = 0; x < kDim; ++x) {
        const auto active = curve.control_points().row(x).segment(span - p, p + 1);
        const double range = active.maxCoeff() - active.minCoeff();
        const long double error = point[x] - (origin[x] + exact.value(x, 0));
        EXPECT_LE(std::abs(static_cast<double>(error)),
                  kEpsilon * ((7 * p + 3) * range + std::abs(point[x])));
      }
    }
  });
}

// Header: (4p + 1)·ε·D·p!/(p−k)!·(2/h)^k, and with weights (k+1)(7p + k + 4)·ε·B_k.
TYPED_TEST(NurbsCurveTest, DerivativesAreRightToTheirBound) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& near, RandomSplines& random) {
    for (const double distance : {0.0, 1e9}) {
      const NurbsCurve<kDim> curve(
          near.basis(), (near.control_points().array() + distance).matrix(), near.weights());
      const double u = random.Parameter(curve.basis());
      const int p = curve.basis().degree(), span = curve.basis().Span(u), order = p + 2;
      const double length = curve.basis().knots()[span + 1] - curve.basis().knots()[span];
      const auto derivatives = curve.Derivatives(u, order);
      const Sized exact = ExtendedCurve(curve, u, order, Origin(curve, u));
      double most = (4 * p + 1) * kEpsilon * Range(curve, span);
      for (int k = 1; k <= order; ++k) {
        most *= std::max(0, p - k + 1) * 2 / length;
        const LongMatrix error =
            derivatives.col(k).template cast<long double>() - exact.value.col(k);
        if (!curve.rational()) {
          EXPECT_LE(static_cast<double>(error.cwiseAbs().maxCoeff()), most) << "order " << k;
          continue;
        }
        const LongMatrix bound = (k + 1) * (7 * p + k + 4) * kEpsilon * exact.size.col(k);
        EXPECT_LE(static_cast<double>((error.cwiseAbs() - bound).maxCoeff()), 0) << "order " << k;
      }
    }
  });
}

TYPED_TEST(NurbsCurveTest, JetHoldsTheFirstThreeDerivatives) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& curve, RandomSplines& random) {
    const double u = random.Parameter(curve.basis());
    const int p = curve.basis().degree();
    const CurveJet<kDim> jet = curve.JetAt(u);
    const auto all = curve.Derivatives(u, 3);
    const Sized exact = ExtendedCurve(curve, u, 3, Origin(curve, u));
    const Eigen::Matrix<double, kDim, 1> columns[] = {jet.point, jet.first, jet.second, jet.third};
    EXPECT_EQ(jet.point, curve.At(u));
    for (int k = 0; k <= 3; ++k) {
      const double bound =
          (k + 1) * (7 * p + k + 4) * kEpsilon * static_cast<double>(exact.size.col(k).maxCoeff());
      EXPECT_NEAR((columns[k] - all.col(k)).cwiseAbs().maxCoeff(), 0, 2 * bound) << "order " << k;
    }
  });
}

// Some of the points coincide, a whole span's at least: nothing moves there.
TYPED_TEST(NurbsCurveTest, CoincidentControlPointsGiveThatPointExactly) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& curve, RandomSplines& random) {
    const int p = curve.basis().degree(), span = AnyOf(curve.basis().Spans(), random);
    auto points = curve.control_points();
    const Eigen::Matrix<double, kDim, 1> point = 1e6 * points.col(span);
    for (int i = 0; i <= p; ++i) points.col(span - p + i) = point;
    // The same basis without its period: the other points stay as they are.
    const NurbsCurve<kDim> still(SplineBasis(p, curve.basis().knots()), points, curve.weights());
    const double low = curve.basis().knots()[span], high = curve.basis().knots()[span + 1];
    const double u = random.Real(low, high);
    EXPECT_EQ(still.At(u), point);
    EXPECT_EQ(still.JetAt(u).point, point);
    EXPECT_TRUE(still.JetAt(u).third.isZero(0));
    EXPECT_TRUE(still.Derivatives(u, p + 1).rightCols(p + 1).isZero(0));
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
      const double h = 1e-3 * (b - a);
      const auto plus = curve.Derivatives(u + h, 3), minus = curve.Derivatives(u - h, 3);
      const auto plus_half = curve.Derivatives(u + h / 2, 3);
      const auto minus_half = curve.Derivatives(u - h / 2, 3);
      const auto difference =
          ((4 * (plus_half - minus_half) / h - (plus - minus) / (2 * h)) / 3).eval();
      // Weights of 10⁴ bend the curve on a scale far below the span: the size of an order is the
      // largest of all orders up to the next but three, on the scale h of the differences times
      // 1000.
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
    if (curve.basis().periodic()) return;  // periodic_test.cc
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

TYPED_TEST(NurbsCurveTest, RefusesProductsThatADoubleCannotHold) {
  constexpr int kDim = TypeParam::value;
  using Points = Eigen::Matrix<double, kDim, Eigen::Dynamic>;
  const SplineBasis basis(1, {0, 0, 1, 1});
  Points points = Points::Zero(kDim, 2);
  points(0, 0) = -1.7e308;
  points(0, 1) = 1.7e308;
  EXPECT_THROW(NurbsCurve<kDim>(basis, points), std::invalid_argument);
  points /= 1e10;
  EXPECT_NO_THROW(NurbsCurve<kDim>(basis, points, Eigen::Vector2d(1, 1e9)));
  EXPECT_THROW(NurbsCurve<kDim>(basis, points, Eigen::Vector2d(1, 1e11)), std::invalid_argument);
}

TYPED_TEST(NurbsCurveTest, RefusesAParameterThatIsNotANumber) {
  constexpr int kDim = TypeParam::value;
  ForRandomCurves<kDim>([](const NurbsCurve<kDim>& curve, RandomSplines&) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(curve.At(nan), std::invalid_argument);
    EXPECT_THROW(curve.JetAt(nan), std::invalid_argument);
    EXPECT_THROW(curve.Derivatives(nan, 2), std::invalid_argument);
  });
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

}  // namespace batten::internal::nurbs_curve_test
