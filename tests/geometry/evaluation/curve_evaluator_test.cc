// SPDX-License-Identifier: MIT
#include "batten/geometry/curve_evaluator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "exact_shapes.h"
#include "extended_evaluation.h"
#include "fixtures.h"
#include "law_cases.h"
#include "random_splines.h"

namespace batten::internal::curve_evaluator_test {

// What the header promises of rounding.
constexpr double kPromised = 1e-13;

template <int Dim>
using JetColumns = Eigen::Matrix<double, Dim, 4>;

template <int Dim>
JetColumns<Dim> Columns(const CurveJet<Dim>& jet) {
  JetColumns<Dim> columns;
  columns << jet.point, jet.first, jet.second, jet.third;
  return columns;
}

template <int Dim>
Eigen::VectorXd CentreOf(const NurbsCurve<Dim>& curve) {
  const auto& points = curve.control_points();
  return points.rowwise().minCoeff() / 2 + points.rowwise().maxCoeff() / 2;
}

template <int Dim>
void ExpectRoundedJet(const CurveEvaluator<Dim>& evaluator, double u) {
  SCOPED_TRACE("u = " + std::to_string(u));
  const NurbsCurve<Dim>& curve = evaluator.curve();
  const double inside = curve.basis().Clamp(u);
  const Eigen::VectorXd centre = CentreOf(curve);
  const Sized exact = ExtendedCurve(curve, inside, 3, centre);
  JetColumns<Dim> wanted = exact.value.template cast<double>();
  wanted.col(0) += centre;
  JetColumns<Dim> allowed = kPromised * exact.size.template cast<double>();
  allowed.col(0) += kEpsilon * wanted.col(0).cwiseAbs();
  const JetColumns<Dim> error = (Columns(evaluator.JetAt(u)) - wanted).cwiseAbs();
  EXPECT_TRUE((error.array() <= allowed.array()).all()) << error << "\nallowed\n" << allowed;
  const auto point_error = (evaluator.At(u) - wanted.col(0)).cwiseAbs().eval();
  EXPECT_TRUE((point_error.array() <= allowed.col(0).array()).all()) << point_error;
}

// A parameter of the domain or within a period around it.
double AnyParameter(const SplineBasis& basis, RandomSplines& random) {
  const double length = basis.upper() - basis.lower();
  if (random.Integer(0, 4) > 0) return random.Parameter(basis);
  return random.Real(basis.lower() - length, basis.upper() + length);
}

template <int Dim>
void CheckRounding() {
  ForRandomCurves<Dim>([](const NurbsCurve<Dim>& curve, RandomSplines& random) {
    const CurveEvaluator<Dim> evaluator(curve);
    for (int k = 0; k < 15; ++k) ExpectRoundedJet(evaluator, AnyParameter(curve.basis(), random));
  });
}

TEST(CurveEvaluatorTest, JetsAreRightWithinThePromisedRounding) {
  CheckRounding<2>();
  CheckRounding<3>();
}

// Spans of lengths 10^-9 … 1, far from zero.
TEST(CurveEvaluatorTest, UnevenSpansLoseNothing) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    std::vector<double> breaks(1, random.Coin() ? 0.0 : 1000.0);
    for (int k = random.Integer(2, 60); k > 0; --k) {
      breaks.push_back(breaks.back() + random.Logarithmic(1e-9, 1));
    }
    SplineBasis basis = SplineBasis::Clamped(random.Integer(1, 7), breaks);
    Eigen::Matrix3Xd points(3, basis.size());
    for (double& x : points.reshaped()) x = random.Real(-1, 1);
    const bool rational = random.Coin();
    const Eigen::VectorXd weights = rational ? random.Weights(points.cols()) : Eigen::VectorXd();
    const CurveEvaluator<3> evaluator(NurbsCurve<3>(basis, points, weights));
    for (double knot : breaks) {
      for (double at : {knot, std::nextafter(knot, 1e9), std::nextafter(knot, -1e9)}) {
        ExpectRoundedJet(evaluator, at);
      }
    }
  }
}

TEST(CurveEvaluatorTest, KnotsBelongToTheSpanOnTheirRight) {
  const CurveEvaluator<2> corner(NurbsCurve<2>(SplineBasis(1, {0, 0, 1, 2, 2}),
                                               Eigen::Matrix<double, 2, 3>{{0, 1, 2}, {0, 1, 0}}));
  EXPECT_NEAR(corner.JetAt(1).first[1], -1, 1e-14);
  EXPECT_NEAR(corner.JetAt(std::nextafter(1.0, 0.0)).first[1], 1, 1e-14);
  EXPECT_NEAR(corner.JetAt(2).first[1], -1, 1e-14);  // the upper end: from the left
  EXPECT_EQ(corner.JetAt(0.5).second, Eigen::Vector2d::Zero());
}

TEST(CurveEvaluatorTest, OutsideParametersAreThoseOfTheDomain) {
  RandomSplines random(5);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 60; ++k) {
    const CurveEvaluator<3> evaluator(
        random.Curve<3>(random.Integer(1, 6), k % 2 == 1, KindOfBasis(k % 3)));
    const SplineBasis& basis = evaluator.curve().basis();
    const double u = random.Real(-50, 50);
    EXPECT_EQ(Columns(evaluator.JetAt(u)), Columns(evaluator.JetAt(basis.Clamp(u))));
    EXPECT_THROW(evaluator.At(NAN), std::invalid_argument);
    if (basis.periodic()) {
      EXPECT_THROW(evaluator.At(kInfinity), std::invalid_argument);
    } else {
      EXPECT_EQ(evaluator.At(kInfinity), evaluator.At(basis.upper()));
      EXPECT_EQ(evaluator.At(-kInfinity), evaluator.At(basis.lower()));
    }
  }
}

template <int Dim>
void CheckSameBits(int degree, bool rational, const BasisKind& kind) {
  RandomSplines random(static_cast<unsigned>(degree));
  ThreadPool pool(3);
  const CurveEvaluator<Dim> evaluator(random.Curve<Dim>(degree, rational, kind));
  std::vector<double> at(9001);
  for (double& u : at) u = AnyParameter(evaluator.curve().basis(), random);
  typename CurveEvaluator<Dim>::PointColumns points, other;
  evaluator.Points(at, points);
  evaluator.Points(at, other, pool);
  EXPECT_EQ(points, other);
  for (int order = 0; order <= 3; ++order) {
    typename CurveEvaluator<Dim>::PointColumns columns;
    evaluator.Derivatives(at, order, columns);
    evaluator.Derivatives(at, order, other, pool);
    EXPECT_EQ(columns, other);
    for (size_t k = 0; k < at.size(); k += 10) {
      const Eigen::Index first = static_cast<Eigen::Index>(k) * (order + 1);
      evaluator.Derivatives({&at[k], 1}, order, other);
      ASSERT_EQ(columns.middleCols(first, order + 1), other);
      ASSERT_EQ(evaluator.At(at[k]), points.col(static_cast<Eigen::Index>(k)));
    }
  }
}

TEST(CurveEvaluatorTest, OneOrManyAndAnyNumberOfThreadsAreTheSameBits) {
  for (int degree = 1; degree <= 7; ++degree) {
    for (int kind = 0; kind < kBasisKinds; ++kind) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", kind " + std::to_string(kind));
      CheckSameBits<2>(degree, kind % 2 == 0, KindOfBasis(kind));
      CheckSameBits<3>(degree, kind % 2 == 1, KindOfBasis(kind));
    }
  }
}

TEST(CurveEvaluatorTest, ACircleStaysOnItsRadius) {
  const CurveEvaluator<2> circle(Circle(3));
  for (int k = 0; k <= 1000; ++k) {
    EXPECT_NEAR(circle.At(k / 1000.0).norm(), 3, 8 * kEpsilon * 3) << k;
  }
}

TEST(CurveEvaluatorTest, FarFromTheOriginDerivativesKeepAllDigits) {
  RandomSplines random(12);
  for (int k = 0; k < 20; ++k) {
    const NurbsCurve<3> raw = random.Curve<3>(random.Integer(1, 8), k % 2 == 1);
    Eigen::Matrix3Xd points = raw.control_points();
    for (double& x : points.reshaped()) x = std::round(x * 0x1p20) * 0x1p-20;
    const CurveEvaluator<3> near(NurbsCurve<3>(raw.basis(), points, raw.weights()));
    points.array() += 0x1p30;
    const CurveEvaluator<3> far(NurbsCurve<3>(raw.basis(), points, raw.weights()));
    const double u = random.Parameter(raw.basis());
    EXPECT_EQ(Columns(near.JetAt(u)).rightCols<3>(), Columns(far.JetAt(u)).rightCols<3>());
  }
}

TEST(CurveEvaluatorTest, RefusesOrdersItHasNoTablesFor) {
  RandomSplines random(1);
  const CurveEvaluator<3> evaluator(random.Curve<3>(3, false));
  Eigen::Matrix3Xd columns;
  EXPECT_THROW(evaluator.Derivatives({}, -1, columns), std::invalid_argument);
  EXPECT_THROW(evaluator.Derivatives({}, 4, columns), std::invalid_argument);
  evaluator.Derivatives({}, 3, columns);
  EXPECT_EQ(columns.cols(), 0);
}

TEST(CurveEvaluatorTest, ACopyOutlivesItsOriginal) {
  RandomSplines random(2);
  auto original = std::make_unique<CurveEvaluator<3>>(random.Curve<3>(3, true));
  const Eigen::Vector3d point = original->At(0.1), outside = original->At(100);
  const CurveEvaluator<3> copy = *original;
  original.reset();
  EXPECT_EQ(copy.At(0.1), point);
  EXPECT_EQ(copy.At(100), outside);
}

template <int Dim>
void CheckFixture(const fixtures::Json& input, const fixtures::Json& expected, double tolerance) {
  const CurveEvaluator<Dim> evaluator(fixtures::Curve<Dim>(input.at("curve")));
  const double u = input.at("u");
  if (expected.contains("ders")) {
    const Eigen::MatrixXd wanted = fixtures::Columns(expected.at("ders"));
    const Eigen::Index count = std::min<Eigen::Index>(4, wanted.cols());
    const JetColumns<Dim> got = Columns(evaluator.JetAt(u));
    EXPECT_LE((got.leftCols(count) - wanted.leftCols(count)).cwiseAbs().maxCoeff(),
              tolerance * std::max(1.0, wanted.cwiseAbs().maxCoeff()));
  } else if (expected.contains("point")) {
    fixtures::ExpectClose(evaluator.At(u), fixtures::Vector(expected.at("point")), tolerance);
  }
}

TEST(CurveEvaluatorTest, AgreesWithOtherImplementations) {
  fixtures::CheckAll(
      "curve_eval.json",
      [](const fixtures::Json& input, const fixtures::Json& expected, double tolerance) {
        if (fixtures::InPlane(input.at("curve"))) {
          CheckFixture<2>(input, expected, tolerance);
        } else {
          CheckFixture<3>(input, expected, tolerance);
        }
      });
}

}  // namespace batten::internal::curve_evaluator_test
