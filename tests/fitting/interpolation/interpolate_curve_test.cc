// SPDX-License-Identifier: MIT
#include "batten/fitting/interpolate_curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "fixtures.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::interpolate_curve_test {

using testing::HasSubstr;

template <int Dim>
Eigen::Matrix<double, Dim, Eigen::Dynamic> Walk(RandomSplines& random, int count) {
  Eigen::Matrix<double, Dim, Eigen::Dynamic> points(Dim, count);
  for (int k = 0; k < count; ++k) {
    points.col(k) = random.Vector(1).template head<Dim>();
    if (k > 0) points.col(k) += points.col(k - 1);
  }
  return points;
}

template <int Dim>
double LargestMiss(const InterpolatedCurve<Dim>& result,
                   const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points) {
  double most = 0;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    most = std::max(most, (result.curve.At(result.parameters[k]) - points.col(k)).norm());
  }
  return most;
}

// Rounding in the curve's value: relative to the control points, which swing further than the
// points for high degrees.
template <typename Curve>
double Allowed(const Curve& curve) {
  return kRounding * (SizeOf(curve) + 1e-3 * ExtentOf(curve));
}

template <int Dim>
void CheckFixtures(const fixtures::Json& input, const fixtures::Json& expected, double tolerance) {
  CurveInterpolationOptions options;
  options.degree = input.at("degree");
  options.parameterization = input.at("parameters_method") == "chord"
                                 ? CurveParameterization::kChord
                                 : CurveParameterization::kCentripetal;
  const InterpolatedCurve<Dim> result =
      InterpolateCurve<Dim>(fixtures::Columns(input.at("points")), options);
  fixtures::ExpectClose(result.parameters, fixtures::Vector(expected.at("parameters")), tolerance);
  const NurbsCurve<Dim> curve = fixtures::Curve<Dim>(expected.at("curve"));
  fixtures::ExpectClose(Eigen::Map<const Eigen::VectorXd>(result.curve.basis().knots().data(),
                                                          result.curve.basis().knots().size()),
                        fixtures::Vector(expected.at("curve").at("knots")),
                        tolerance);
  fixtures::ExpectClose(result.curve.control_points(), curve.control_points(), tolerance);
}

TEST(InterpolateCurveTest, AgreesWithOtherImplementations) {
  int cases = 0;
  fixtures::CheckAll(
      "curve_interpolation.json",
      [&](const fixtures::Json& input, const fixtures::Json& expected, double tolerance) {
        if (!input.contains("parameters_method")) return;
        ++cases;
        if (input.at("points").at(0).size() == 2) {
          CheckFixtures<2>(input, expected, tolerance);
        } else {
          CheckFixtures<3>(input, expected, tolerance);
        }
      });
  EXPECT_EQ(cases, 21);
}

TEST(InterpolateCurveTest, GoesThroughItsPoints) {
  constexpr CurveParameterization kKinds[] = {CurveParameterization::kChord,
                                              CurveParameterization::kCentripetal,
                                              CurveParameterization::kFoley,
                                              CurveParameterization::kUniversal};
  for (unsigned seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    CurveInterpolationOptions options;
    options.degree = random.Integer(1, 9);
    options.parameterization = kKinds[seed % 4];
    const Eigen::Matrix3Xd points = Walk<3>(random, random.Integer(options.degree + 1, 60));
    const InterpolatedCurve<3> result = InterpolateCurve<3>(points, options);
    EXPECT_LE(LargestMiss(result, points), Allowed(result.curve));
    EXPECT_EQ(result.curve.At(result.parameters[0]), points.col(0));
    EXPECT_EQ(result.curve.At(result.parameters[points.cols() - 1]), points.col(points.cols() - 1));
    EXPECT_EQ(result.curve.basis().degree(), options.degree);
  }
}

TEST(InterpolateCurveTest, ClosedCurvesGoThroughTheirPointsAndAreSmoothAtTheSeam) {
  for (unsigned seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    CurveInterpolationOptions options;
    options.closed = true;
    options.degree = random.Integer(1, 7);
    // Of even degree a solution is sure for steps that do not vary much only.
    const int count = random.Integer(3, 40);
    Eigen::Matrix2Xd points(2, count);
    for (int k = 0; k < count; ++k) {
      const double angle = 2 * std::numbers::pi * (k + random.Real(-0.1, 0.1)) / count,
                   radius = random.Real(0.9, 1);
      points.col(k) << radius * std::cos(angle), radius * std::sin(angle);
    }
    const InterpolatedCurve<2> result = InterpolateCurve<2>(points, options);
    EXPECT_LE(LargestMiss(result, points), 10 * Allowed(result.curve));
    EXPECT_TRUE(result.curve.basis().periodic());
    EXPECT_EQ(result.curve.basis().size(), count + options.degree);
    EXPECT_EQ(result.curve.basis().lower(), 0);
    EXPECT_EQ(result.curve.basis().upper(), 1);
    const int order = options.degree - 1;
    const Eigen::Matrix2Xd first = result.curve.Derivatives(0, order),
                           last = result.curve.Derivatives(1, order);
    for (int k = 0; k <= order; ++k) {
      EXPECT_LE((first.col(k) - last.col(k)).norm(),
                1e-9 * (first.col(k).norm() + std::pow(2.0 * count, k)));
    }
  }
}

TEST(InterpolateCurveTest, ClosedCurvesOfOddDegreeExistHoweverTheStepsVary) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    CurveInterpolationOptions options;
    options.closed = true;
    options.degree = 2 * random.Integer(0, 2) + 1;
    options.parameterization = CurveParameterization::kGiven;
    const int count = random.Integer(3, 30);
    options.parameters.resize(count + 1);
    double u = random.Real(-5, 5);
    for (double& value : options.parameters) {
      value = u;
      u += random.Logarithmic(1e-2, 1);
    }
    const Eigen::Matrix3Xd points = Walk<3>(random, count);
    const InterpolatedCurve<3> result = InterpolateCurve<3>(points, options);
    EXPECT_LE(LargestMiss(result, points), 10 * Allowed(result.curve));
    EXPECT_EQ(result.curve.basis().lower(), options.parameters[0]);
    EXPECT_EQ(result.curve.basis().upper(), options.parameters[count]);
  }
}

TEST(InterpolateCurveTest, ACurveOfTheSplineSpaceIsRecovered) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(1, 6);
    const NurbsCurve<3> curve =
        random.Curve<3>(degree, false, {.highest_multiplicity = 1, .periodic = random.Coin()});
    const SplineBasis& basis = curve.basis();
    CurveInterpolationOptions options;
    options.degree = degree;
    options.basis = basis;
    options.closed = basis.periodic();
    options.parameterization = CurveParameterization::kGiven;
    const int count = basis.size() - (basis.periodic() ? degree : 0);
    if (basis.periodic() && (count < 3 || degree % 2 == 0)) continue;
    options.parameters.resize(count + (basis.periodic() ? 1 : 0));
    for (int i = 0; i < count; ++i) {
      options.parameters[i] = basis.periodic() ? basis.knots()[degree + i] : basis.Greville(i);
    }
    if (basis.periodic()) options.parameters[count] = basis.upper();
    Eigen::Matrix3Xd points(3, count);
    for (int i = 0; i < count; ++i) points.col(i) = curve.At(options.parameters[i]);
    const InterpolatedCurve<3> result = InterpolateCurve<3>(points, options);
    EXPECT_LE((result.curve.control_points() - curve.control_points()).norm(),
              kIterated * SizeOf(curve));
  }
}

TEST(InterpolateCurveTest, TakesTheDerivativesGiven) {
  for (unsigned seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    CurveInterpolationOptions options;
    options.degree = random.Integer(2, 6);
    options.closed = seed % 4 == 0;
    options.parameterization = CurveParameterization::kCentripetal;
    const int count = random.Integer(options.degree + 1, 25);
    const Eigen::Matrix3Xd points = Walk<3>(random, count);
    // All first derivatives, those of the ends, or some of consecutive orders here and there.
    std::vector<PointDerivative<3>> derivatives;
    for (int k = 0; k < count; ++k) {
      const bool end = k == 0 || k == count - 1;
      int orders = seed % 3 == 0 ? 1 : seed % 3 == 1 ? int{end} : 0;
      if (seed % 3 == 2 && random.Integer(0, 3) == 0) {
        orders = random.Integer(1, std::min(2, options.degree - 1));
      }
      if (options.closed) orders = std::min(orders, (options.degree - 1) / 2);
      for (int order = 1; order <= orders; ++order) {
        derivatives.push_back({k, order, std::pow(count, order) * random.Vector(1)});
      }
    }
    const InterpolatedCurve<3> result = InterpolateCurve<3>(points, options, derivatives);
    EXPECT_LE(LargestMiss(result, points), 100 * Allowed(result.curve));
    for (const PointDerivative<3>& d : derivatives) {
      const Eigen::Matrix3Xd got =
          result.curve.Derivatives(result.parameters[d.point], options.degree);
      // Differences of control points over the shortest steps.
      EXPECT_LE((got.col(d.order) - d.value).norm(), kIterated * got.norm());
    }
  }
}

TEST(InterpolateCurveTest, PlaceAndUnitsOfThePointsDoNotMatter) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Eigen::Matrix3Xd points = Walk<3>(random, random.Integer(4, 40));
    const double scale = random.Logarithmic(1e-6, 1e6);
    const Eigen::Vector3d shift = 5e6 * scale * Eigen::Vector3d(1, -0.7, 0.1);
    const Eigen::Matrix3Xd moved = (scale * points).colwise() + shift;
    const InterpolatedCurve<3> a = InterpolateCurve<3>(points), b = InterpolateCurve<3>(moved);
    // Far away the points themselves are rounded to 1e-9 of their size; the curve is as steady.
    EXPECT_LE((b.curve.control_points() - ((scale * a.curve.control_points()).colwise() + shift))
                  .cwiseAbs()
                  .maxCoeff(),
              1e-6 * scale * SizeOf(a.curve));
    EXPECT_LE(LargestMiss(b, moved), 1e-15 * 8 * shift.norm() + scale * Allowed(a.curve));
  }
}

TEST(InterpolateCurveTest, EndTangentsPointWhereTheyAreTold) {
  const Eigen::Matrix2Xd points{{0, 1, 2, 3, 4}, {0, 1, 0, 1, 0}};
  const Eigen::VectorXd u = CurveParameters(points, CurveParameterization::kCentripetal);
  const PointDerivative<2> start =
      EndTangent<2>(points, u, InterpolationEnd::kStart, Eigen::Vector2d(0, 3));
  const PointDerivative<2> end =
      EndTangent<2>(points, u, InterpolationEnd::kEnd, Eigen::Vector2d(1, 0));
  EXPECT_NEAR(start.value[1], std::sqrt(2.0) / 0.25, kRounding * 10);
  CurveInterpolationOptions options;
  options.parameterization = CurveParameterization::kCentripetal;
  const std::vector<PointDerivative<2>> both = {start, end};
  const InterpolatedCurve<2> result = InterpolateCurve<2>(points, options, both);
  EXPECT_NEAR(result.curve.JetAt(0).first.x(), 0, kRounding * 10);
  EXPECT_GT(result.curve.JetAt(0).first.y(), 0);
  EXPECT_NEAR(result.curve.JetAt(1).first.y(), 0, kRounding * 10);
  EXPECT_GT(result.curve.JetAt(1).first.x(), 0);
}

TEST(InterpolateCurveTest, ManyPointsTakeLinearTime) {
  constexpr int kCount = 100000;
  Eigen::Matrix3Xd points(3, kCount);
  for (int k = 0; k < kCount; ++k) {
    const double t = 60 * std::numbers::pi * k / kCount;
    points.col(k) << std::cos(t), std::sin(t), 0.1 * t;
  }
  const InterpolatedCurve<3> open = InterpolateCurve<3>(points);
  EXPECT_LE(LargestMiss(open, points), kRounding * 20);
  CurveInterpolationOptions options;
  options.closed = true;
  const InterpolatedCurve<3> closed = InterpolateCurve<3>(points, options);
  EXPECT_LE(LargestMiss(closed, points), kRounding * 20);
}

TEST(InterpolateCurveTest, AnyDegreeUpToTheHighest) {
  for (const int degree : {10, 15, 20, 25}) {
    SCOPED_TRACE("degree " + std::to_string(degree));
    CurveInterpolationOptions options;
    options.degree = degree;
    Eigen::Matrix2Xd points(2, 60);
    for (int k = 0; k < 60; ++k) points.col(k) << std::cos(k / 10.0), std::sin(k / 10.0);
    const InterpolatedCurve<2> result = InterpolateCurve<2>(points, options);
    EXPECT_LE(LargestMiss(result, points), Allowed(result.curve));
    // A smooth curve does not swing between its points.
    for (int k = 0; k <= 1000; ++k) EXPECT_NEAR(result.curve.At(k / 1000.0).norm(), 1, 1e-6);
    options.closed = true;
    for (int k = 0; k < 60; ++k) {
      const double angle = std::numbers::pi * (k + 0.2 * std::sin(k)) / 30;
      points.col(k) << std::cos(angle), std::sin(angle);
    }
    const InterpolatedCurve<2> closed = InterpolateCurve<2>(points, options);
    EXPECT_LE(LargestMiss(closed, points), Allowed(closed.curve));
  }
}

std::string ErrorOf(const Eigen::Matrix2Xd& points,
                    const CurveInterpolationOptions& options,
                    const std::vector<PointDerivative<2>>& derivatives = {}) {
  try {
    InterpolateCurve<2>(points, options, derivatives);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "none";
}

TEST(InterpolateCurveTest, SaysWhatItCannotDo) {
  const Eigen::Matrix2Xd three{{0, 1, 2}, {0, 1, 0}};
  CurveInterpolationOptions options;
  EXPECT_THAT(ErrorOf(three, options),
              HasSubstr("needs at least 4 points and derivatives; there "
                        "are 3: lower the degree to 2 or add points"));
  const Eigen::Matrix2Xd twice{{0, 1, 1, 2, 3}, {0, 1, 1, 0, 0}};
  EXPECT_THAT(ErrorOf(twice, options), HasSubstr("points 2 and 3 lie in one place"));
  const Eigen::Matrix2Xd round{{0, 1, 1, 0, 0}, {0, 0, 1, 1, 0}};
  EXPECT_EQ(ErrorOf(round, options), "none");
  options.closed = true;
  EXPECT_THAT(ErrorOf(round, options), HasSubstr("points 5 and 1 lie in one place"));
  EXPECT_THAT(ErrorOf(three.leftCols(2), options), HasSubstr("at least 3 different points"));
  options.closed = false;
  EXPECT_THAT(ErrorOf(three.leftCols(1), options), HasSubstr("at least 2 different points"));
  options.degree = 26;
  EXPECT_THAT(ErrorOf(three, options), HasSubstr("between 1 and 25"));
  options.degree = 2;
  options.parameterization = CurveParameterization::kGiven;
  EXPECT_THAT(ErrorOf(three, options), HasSubstr("needs 3 parameters; there are 0"));
  options.parameters = Eigen::Vector3d(0, 2, 1);
  EXPECT_THAT(ErrorOf(three, options), HasSubstr("points 2 and 3 do not increase"));
  options.parameters = Eigen::Vector3d(0, 0.5, 1);
  EXPECT_THAT(ErrorOf(three, options, {{3, 1, {0, 1}}}), HasSubstr("no such point"));
  EXPECT_THAT(ErrorOf(three, options, {{0, 3, {0, 1}}}), HasSubstr("order 3"));
  EXPECT_THAT(ErrorOf(three, options, {{0, 1, {0, 1}}, {0, 1, {1, 1}}}), HasSubstr("given twice"));
  options.basis = QuasiUniformKnots(2, 4, 0, 1);
  EXPECT_THAT(ErrorOf(three, options), HasSubstr("4 different functions for 3 points"));
  const Eigen::Matrix2Xd four{{0, 1, 2, 3}, {0, 1, 0, 1}};
  options.parameters = Eigen::Vector4d(0, 0.1, 0.2, 0.3);
  EXPECT_THAT(ErrorOf(four, options), HasSubstr("Schoenberg-Whitney"));
}

// Four corners of a square: the points repeat every quarter turn, and so does the curve.
TEST(InterpolateCurveTest, AClosedCurveHasTheSymmetryOfItsPoints) {
  const Eigen::Matrix2Xd square{{1, 0, -1, 0}, {0, 1, 0, -1}};
  for (int degree = 1; degree <= 6; ++degree) {
    SCOPED_TRACE("degree " + std::to_string(degree));
    CurveInterpolationOptions options;
    options.degree = degree;
    options.closed = true;
    const InterpolatedCurve<2> result = InterpolateCurve<2>(square, options);
    for (int k = 0; k < 40; ++k) {
      const Eigen::Vector2d here = result.curve.At(k / 40.0),
                            next = result.curve.At(k / 40.0 + 0.25);
      EXPECT_NEAR(next.x(), -here.y(), kRounding);
      EXPECT_NEAR(next.y(), here.x(), kRounding);
    }
  }
}

}  // namespace batten::internal::interpolate_curve_test
