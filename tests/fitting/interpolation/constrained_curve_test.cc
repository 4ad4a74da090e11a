// SPDX-License-Identifier: MIT
#include "batten/fitting/constrained_curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/fitting/curve_parameterization.h"
#include "batten/geometry/knot_vectors.h"
#include "fixtures.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::constrained_curve_test {

using testing::HasSubstr;

std::vector<CurveCondition> ExactEnds(const Eigen::VectorXd& parameters,
                                      const Eigen::MatrixXd& points) {
  const Eigen::Index last = parameters.size() - 1;
  return {{parameters[0], 0, points.col(0)}, {parameters[last], 0, points.col(last)}};
}

std::vector<double> ToVector(const Eigen::VectorXd& v) { return {v.begin(), v.end()}; }

TEST(ConstrainedCurveTest, AgreesWithOtherImplementationsAtGivenKnots) {
  int cases = 0;
  fixtures::CheckAll(
      "curve_least_squares.json",
      [&](const fixtures::Json& input, const fixtures::Json& expected, double tolerance) {
        if (!input.contains("parameters")) return;
        ++cases;
        const Eigen::MatrixXd points = fixtures::Columns(input.at("points"));
        const Eigen::VectorXd parameters = fixtures::Vector(input.at("parameters"));
        Eigen::VectorXd weights;  // there they multiply the residual
        if (!input.at("weights").is_null()) {
          weights = fixtures::Vector(input.at("weights")).array().square();
        }
        std::vector<CurveCondition> ends;
        if (input.at("mode") == "end points interpolated") ends = ExactEnds(parameters, points);
        const SplineBasis basis(input.at("degree"), input.at("knots"));
        const Eigen::MatrixXd control =
            ConstrainedLeastSquares(basis, parameters, points, weights, ends);
        fixtures::ExpectClose(control, fixtures::Columns(expected.at("control_points")), tolerance);
        Eigen::MatrixXd in_space = Eigen::MatrixXd::Zero(3, control.cols());
        in_space.topRows(control.rows()) = control;
        const NurbsCurve<3> curve(basis, in_space);
        double squares = 0, most = 0;
        for (Eigen::Index k = 0; k < points.cols(); ++k) {
          const double d = (curve.At(parameters[k]) - fixtures::InSpace(points.col(k))).norm();
          squares += d * d;
          most = std::max(most, d);
        }
        fixtures::ExpectClose(std::sqrt(squares / static_cast<double>(points.cols())),
                              expected.at("rms").get<double>(),
                              tolerance);
        fixtures::ExpectClose(most, expected.at("max_error").get<double>(), tolerance);
      });
  EXPECT_EQ(cases, 24);
}

TEST(ConstrainedCurveTest, AgreesWithOtherImplementationsWithKnotsFromTheData) {
  int cases = 0;
  fixtures::CheckAll(
      "curve_least_squares.json",
      [&](const fixtures::Json& input, const fixtures::Json& expected, double tolerance) {
        if (input.contains("parameters")) return;
        ++cases;
        const Eigen::Matrix3Xd points = fixtures::Columns(input.at("points"));
        const bool chord = input.at("parameters_method") == "chord";
        const Eigen::VectorXd parameters = CurveParameters(
            points, chord ? CurveParameterization::kChord : CurveParameterization::kCentripetal);
        fixtures::ExpectClose(parameters, fixtures::Vector(expected.at("parameters")), tolerance);
        const SplineBasis basis =
            LeastSquaresKnots(input.at("degree"), input.at("ctrlpts"), ToVector(parameters));
        const NurbsCurve<3> theirs = fixtures::Curve<3>(expected.at("curve"));
        fixtures::ExpectClose(
            Eigen::Map<const Eigen::VectorXd>(basis.knots().data(), basis.knots().size()),
            fixtures::Vector(expected.at("curve").at("knots")),
            tolerance);
        const NurbsCurve<3> curve =
            ConstrainedCurve<3>(basis, parameters, points, {}, ExactEnds(parameters, points));
        fixtures::ExpectClose(curve.control_points(), theirs.control_points(), tolerance);
      });
  EXPECT_EQ(cases, 6);
}

// A problem with more data than control points and exact conditions at a few places.
struct RandomProblem {
  SplineBasis basis = SplineBasis(1, {0, 0, 1, 1});
  Eigen::VectorXd parameters, weights;
  Eigen::MatrixXd values;
  std::vector<CurveCondition> conditions;
};

RandomProblem MakeProblem(RandomSplines& random) {
  RandomProblem problem;
  const int degree = random.Integer(1, 6), dimension = random.Integer(1, 4);
  problem.basis = random.Basis(
      degree,
      {.clamped = random.Coin(), .highest_multiplicity = 1, .periodic = random.Integer(0, 2) == 0});
  const SplineBasis& basis = problem.basis;
  const std::vector<int> spans = basis.Spans();
  const int count = 12 * static_cast<int>(spans.size());
  problem.parameters.resize(count);
  for (int k = 0; k < count; ++k) {
    const int span = spans[k / 12];
    problem.parameters[k] = random.Real(basis.knots()[span], basis.knots()[span + 1]);
  }
  problem.values = Eigen::MatrixXd(dimension, count);
  for (double& x : problem.values.reshaped()) x = random.Real(-1, 1);
  if (random.Coin()) problem.weights = random.Weights(count, 0.1, 10);
  const auto value = [&] {
    Eigen::VectorXd v(dimension);
    for (double& x : v) x = random.Real(-1, 1);
    return v;
  };
  // Exact: one value and one derivative; with a weight: two derivatives.
  if (random.Coin()) problem.conditions.push_back({random.Parameter(basis), 0, value()});
  if (random.Coin() && degree > 1 && basis.size() > degree + (basis.periodic() ? 3 : 1)) {
    problem.conditions.push_back({random.Real(basis.lower(), basis.upper()), 1, value()});
  }
  for (int k = 0; k < 2; ++k) {
    problem.conditions.push_back({random.Parameter(basis), 1, value(), random.Real(0.01, 1)});
  }
  return problem;
}

Eigen::VectorXd ValueAt(const SplineBasis& basis,
                        const Eigen::MatrixXd& control,
                        double u,
                        int order) {
  const int p = basis.degree(), span = basis.Span(u);
  std::vector<double> values((order + 1) * (p + 1));
  basis.Derivatives(span, u, order, values.data());
  Eigen::VectorXd result = Eigen::VectorXd::Zero(control.rows());
  for (int r = 0; r <= p; ++r) result += values[order * (p + 1) + r] * control.col(span - p + r);
  return result;
}

double Objective(const RandomProblem& problem, const Eigen::MatrixXd& control) {
  double sum = 0;
  for (Eigen::Index k = 0; k < problem.parameters.size(); ++k) {
    const double w = problem.weights.size() > 0 ? problem.weights[k] : 1;
    sum += w * (ValueAt(problem.basis, control, problem.parameters[k], 0) - problem.values.col(k))
                   .squaredNorm();
  }
  for (const CurveCondition& c : problem.conditions) {
    if (!c.weight) continue;
    sum += *c.weight * (ValueAt(problem.basis, control, c.u, c.order) - c.value).squaredNorm();
  }
  return sum;
}

// Meets what is exact; and every step that keeps it makes the sum larger, by as much both ways.
TEST(ConstrainedCurveTest, NothingThatMeetsTheConditionsIsBetter) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const RandomProblem problem = MakeProblem(random);
    const SplineBasis& basis = problem.basis;
    const Eigen::MatrixXd control = ConstrainedLeastSquares(
        basis, problem.parameters, problem.values, problem.weights, problem.conditions);
    const int distinct = basis.size() - (basis.periodic() ? basis.degree() : 0);
    for (int i = distinct; i < basis.size(); ++i) {
      EXPECT_EQ(control.col(i), control.col(i - distinct));
    }
    std::vector<Eigen::VectorXd> normals;
    for (const CurveCondition& c : problem.conditions) {
      if (c.weight) continue;
      const double size = 1 + control.cwiseAbs().maxCoeff();
      // Derivatives lose two digits to the shortest spans of 0.05.
      EXPECT_LE((ValueAt(basis, control, c.u, c.order) - c.value).norm(),
                (c.order == 0 ? 1 : 1e3) * 10 * kRounding * size);
      Eigen::VectorXd normal = Eigen::VectorXd::Zero(distinct);
      for (int i = 0; i < basis.size(); ++i) {
        normal[i % distinct] += basis.FunctionDerivatives(i, c.u, c.order)[c.order];
      }
      for (const Eigen::VectorXd& n : normals) normal -= n * n.dot(normal);
      normals.push_back(normal.normalized());
    }
    const double least = Objective(problem, control);
    for (int k = 0; k < 5; ++k) {
      Eigen::MatrixXd change(control.rows(), distinct);
      for (double& x : change.reshaped()) x = random.Real(-1, 1);
      for (const Eigen::VectorXd& n : normals) change -= (change * n) * n.transpose();
      const auto changed = [&](double by) {
        Eigen::MatrixXd result = control;
        for (int i = 0; i < basis.size(); ++i) result.col(i) += by * change.col(i % distinct);
        return Objective(problem, result);
      };
      const double up = changed(1e-3) - least, down = changed(-1e-3) - least;
      EXPECT_GE(std::min(up, down), 0);
      EXPECT_NEAR(up, down, kIterated * (1 + least));
    }
  }
}

TEST(ConstrainedCurveTest, PlaceAndUnitsOfTheDataDoNotMatter) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    RandomProblem problem = MakeProblem(random);
    const Eigen::MatrixXd before = ConstrainedLeastSquares(
        problem.basis, problem.parameters, problem.values, problem.weights, problem.conditions);
    const double scale = random.Logarithmic(1e-6, 1e6), away = 1e6 * scale;
    problem.values = (scale * problem.values).array() + away;
    if (problem.weights.size() > 0) problem.weights *= 1e9;
    for (CurveCondition& c : problem.conditions) {
      c.value = (scale * c.value).array() + (c.order == 0 ? away : 0);
      if (c.weight && problem.weights.size() > 0) *c.weight *= 1e9;
    }
    const Eigen::MatrixXd after = ConstrainedLeastSquares(
        problem.basis, problem.parameters, problem.values, problem.weights, problem.conditions);
    // Far away ten digits of the values are left; the equations take three at most.
    EXPECT_LE(((after.array() - away) / scale - before.array()).abs().maxCoeff(),
              1e-7 * before.cwiseAbs().maxCoeff());
  }
}

TEST(ConstrainedCurveTest, ConditionsAloneDetermineASpline) {
  const SplineBasis basis = QuasiUniformKnots(3, 4, 0, 1);
  const auto value = [](double x) { return Eigen::VectorXd(Eigen::VectorXd::Constant(1, x)); };
  const Eigen::MatrixXd control = ConstrainedLeastSquares(
      basis,
      Eigen::VectorXd(),
      Eigen::MatrixXd(1, 0),
      {},
      {{0, 0, value(1)}, {0, 1, value(3)}, {1, 1, value(6)}, {1, 0, value(2)}});
  EXPECT_LE((control - Eigen::RowVector4d(1, 2, 0, 2)).norm(), kRounding * 10);
}

TEST(ConstrainedCurveTest, ManyConditionsAndDataTakeLinearTime) {
  constexpr int kSpans = 5000;
  for (const bool periodic : {false, true}) {
    const SplineBasis basis =
        periodic ? PeriodicUniformKnots(3, kSpans, 0, 1) : QuasiUniformKnots(3, kSpans + 3, 0, 1);
    constexpr int kCount = 50000;
    Eigen::VectorXd parameters(kCount);
    Eigen::MatrixXd values(2, kCount);
    const auto shape = [](double u) {
      Eigen::VectorXd point(2);
      point << std::cos(6.283185307179586 * u), std::sin(6.283185307179586 * u);
      return point;
    };
    for (int k = 0; k < kCount; ++k) {
      parameters[k] = (k + 0.5) / kCount;
      values(0, k) = std::cos(6.283185307179586 * parameters[k]);
      values(1, k) = std::sin(6.283185307179586 * parameters[k]);
    }
    std::vector<CurveCondition> conditions;
    const int number = periodic ? 50 : 2000;
    for (int k = 0; k < number; ++k) {
      const double u = (k + 0.3) / number;
      conditions.push_back({u, 0, 1.001 * shape(u)});
    }
    const NurbsCurve<2> curve = ConstrainedCurve<2>(basis, parameters, values, {}, conditions);
    for (const CurveCondition& c : conditions) {
      EXPECT_LE((curve.At(c.u) - c.value).norm(), kRounding * 10);
    }
  }
}

TEST(ConstrainedCurveTest, SaysWhatItCannotDo) {
  const SplineBasis basis = QuasiUniformKnots(3, 6, 0, 3);
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(30, 0, 3);
  const Eigen::MatrixXd values = Eigen::MatrixXd::Random(2, 30);
  const auto error = [&](const Eigen::VectorXd& at,
                         const Eigen::MatrixXd& q,
                         const std::vector<CurveCondition>& conditions) {
    try {
      ConstrainedLeastSquares(basis, at, q, {}, conditions);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  const Eigen::Vector2d zero(0, 0);
  EXPECT_THAT(error(u, values, {{1.5, 0, zero}, {2, 0, zero}, {1.5, 0, zero}}),
              HasSubstr("condition 3 (point at u = 1.5) follows from"));
  EXPECT_THAT(
      error(u,
            values,
            {{0.1, 0, zero}, {0.2, 0, zero}, {0.3, 0, zero}, {0.4, 0, zero}, {0.5, 0, zero}}),
      HasSubstr("condition 5 (point at u = 0.5) follows from"));
  EXPECT_THAT(error(u, values, {{1.5, 4, zero}}), HasSubstr("order"));
  EXPECT_THAT(error(u, values, {{3.5, 0, zero}}), HasSubstr("leaves the domain"));
  EXPECT_THAT(error(u, values, {{1.5, 0, Eigen::Vector3d(0, 0, 0)}}), HasSubstr("2 finite"));
  EXPECT_THAT(error(u, values.leftCols(20), {}), HasSubstr("do not agree"));
  EXPECT_THAT(error(u.head(12), values.leftCols(12), {}), HasSubstr("near u = 3"));
  const Eigen::VectorXd few = Eigen::VectorXd::LinSpaced(5, 0, 3);
  EXPECT_THAT(error(few, values.leftCols(5), {}), HasSubstr("do not determine"));
  EXPECT_EQ(error(few, values.leftCols(5), {{3, 1, zero}}), "none");
}

}  // namespace batten::internal::constrained_curve_test
