// SPDX-License-Identifier: MIT
#include "fitting/knots/variable_projection.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "batten/fitting/solve_linear.h"
#include "fitting/knots/knot_descent.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::variable_projection_test {

// How far data keep away from knots: differences then meet no jump of a derivative.
constexpr double kApart = 3e-4;

double ParameterBetweenKnots(RandomSplines& random, const SplineBasis& basis) {
  for (;;) {
    const double t = random.Real(basis.lower(), basis.upper());
    const auto near = [&](double knot) { return std::abs(knot - t) < kApart; };
    if (std::none_of(basis.knots().begin(), basis.knots().end(), near)) return t;
  }
}

struct Case {
  FittingProblem problem;
  MovingKnots knots;
};

// Smooth data and many of them in every cell, of one dimension or three, weighted or not.
Case RandomCase(RandomSplines& random, bool curve, double smoothing) {
  const BasisKind kind{.clamped = random.Coin(), .most_spans = curve ? 6 : 4};
  const SplineBasis u = random.Basis(random.Integer(2, curve ? 5 : 3), kind);
  const SplineBasis v = random.Basis(random.Integer(2, 3), kind);
  const int d = random.Coin() ? 1 : 3, m = curve ? 300 : 1500;
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, m);
  data->values.resize(d, m);
  if (random.Coin()) data->weights.resize(m);
  for (double& w : data->weights) w = random.Integer(0, 5) == 0 ? 0 : random.Real(0.5, 2);
  const double a = random.Real(2, 5), b = random.Real(1, 3);
  for (int k = 0; k < m; ++k) {
    const double s = ParameterBetweenKnots(random, u);
    const double t = curve ? 0 : ParameterBetweenKnots(random, v);
    data->parameters.col(k) << s, t;
    for (int e = 0; e < d; ++e) data->values(e, k) = 7 + std::sin(a * s + e) * std::cos(b * t - e);
  }
  if (curve) return {FittingProblem(u, data, smoothing), {KnotGaps(u), std::nullopt, true, false}};
  const bool move_u = random.Coin();
  return {FittingProblem(u, v, data, smoothing),
          {KnotGaps(u), KnotGaps(v), move_u, !move_u || random.Coin()}};
}

template <class Law>
void ForRandomCases(double smoothing, const Law& law) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    law(random, RandomCase(random, seed % 2 == 0, smoothing));
    if (testing::Test::HasFailure()) return;
  }
}

TEST(VariableProjectionTest, ItsSquaresAreThoseOfTheLinearSolution) {
  for (const double smoothing : {0.0, 1e-4}) {
    ForRandomCases(smoothing, [](RandomSplines&, const Case& c) {
      ThreadPool pool(2);
      const LinearSolution solution = SolveLinear(c.problem, pool);
      const auto value = VariableProjection(c.problem).Evaluate(c.knots, pool);
      ASSERT_EQ(value.has_value(), !solution.regularised);
      if (!value) return;
      const double scale = VariableProjection(c.problem).squares();
      EXPECT_NEAR(
          value->squares, solution.residual_squares, kRounding * 49 * 1500 + kIterated * scale);
      EXPECT_LE(value->squares, value->cost * (1 + kRounding));
    });
  }
}

TEST(VariableProjectionTest, ItsGradientIsThatOfDifferences) {
  ForRandomCases(0, [](RandomSplines&, const Case& c) {
    ThreadPool pool(1);
    const VariableProjection projection(c.problem);
    const auto value = projection.Linearise(c.knots, pool);
    if (!value || c.knots.free() == 0) return;
    ASSERT_EQ(value->gradient.size(), c.knots.free());
    for (const bool in_u : {true, false}) {
      const int groups = in_u ? c.knots.free_u() : c.knots.free_v();
      for (int g = 0; g < groups; ++g) {
        // A knot moved by a little of the narrower gap beside it, in the variables that allow it.
        const KnotGaps& gaps = in_u ? c.knots.u : *c.knots.v;
        const std::vector<double> h = gaps.Gaps();
        const double step = 1e-4 * std::min(h[g], h[g + 1]);
        double cost[2];
        for (int side = 0; side < 2; ++side) {
          const double move = side == 0 ? -step : step;
          Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(h.data(), std::ssize(h));
          x[g] += move;
          x[g + 1] -= move;
          MovingKnots moved = c.knots;
          (in_u ? moved.u : *moved.v) = *gaps.At(x.array().log());
          const auto at = projection.Evaluate(moved, pool);
          ASSERT_TRUE(at);
          cost[side] = at->cost;
        }
        const double slope = (cost[1] - cost[0]) / (2 * step);
        const double expected = 2 * value->gradient[in_u ? g : c.knots.free_u() + g];
        // A third derivative is of the size of Φ/h³, and Φ is right to some roundings of Σ w|z|².
        const double least = std::min(h[g], h[g + 1]);
        const double tolerance = 100 * step * step * value->cost / std::pow(least, 3) +
                                 1e-14 * projection.squares() / step;
        EXPECT_NEAR(slope, expected, tolerance) << (in_u ? "u " : "v ") << g;
      }
    }
  });
}

// Against the projection written out with dense matrices and differences of the design matrix.
TEST(VariableProjectionTest, ItsNormalMatrixIsKaufmans) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Case c = RandomCase(random, true, 0);
    ThreadPool pool(1);
    const VariableProjection projection(c.problem);
    const auto value = projection.Linearise(c.knots, pool);
    if (!value || c.knots.free() == 0) continue;
    const FittingData& data = c.problem.data();
    const Eigen::Index m = data.parameters.cols();
    const auto design = [&](const SplineBasis& basis, const SplineBasis& spans) {
      Eigen::MatrixXd B = Eigen::MatrixXd::Zero(m, basis.size());
      std::vector<double> N(kMaxDegree + 1);
      for (Eigen::Index k = 0; k < m; ++k) {
        const int span = spans.Span(data.parameters(0, k));
        basis.Values(span, data.parameters(0, k), N.data());
        const double root = data.weights.size() > 0 ? std::sqrt(data.weights[k]) : 1.0;
        for (int r = 0; r <= basis.degree(); ++r) B(k, span - basis.degree() + r) = root * N[r];
      }
      return B;
    };
    const KnotGaps& gaps = c.knots.u;
    const Eigen::MatrixXd B = design(gaps.basis(), gaps.basis());
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(B);
    Eigen::MatrixXd z = data.values.transpose();
    if (data.weights.size() > 0) z = data.weights.cwiseSqrt().asDiagonal() * z;
    const Eigen::MatrixXd coefficients = qr.solve(z);
    const auto d = static_cast<int>(z.cols());
    Eigen::MatrixXd J(m * d, gaps.groups());
    const std::vector<double> h = gaps.Gaps();
    for (int g = 0; g < gaps.groups(); ++g) {
      const double step = 1e-6 * std::min(h[g], h[g + 1]);
      Eigen::MatrixXd difference = Eigen::MatrixXd::Zero(m, B.cols());
      for (const double sign : {-1.0, 1.0}) {
        Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(h.data(), std::ssize(h));
        x[g] += sign * step;
        x[g + 1] -= sign * step;
        difference += sign / (2 * step) * design(gaps.At(x.array().log())->basis(), gaps.basis());
      }
      for (int e = 0; e < d; ++e) {
        const Eigen::VectorXd D = difference * coefficients.col(e);
        J.col(g).segment(e * m, m) = D - B * qr.solve(D);
      }
    }
    const Eigen::MatrixXd normal = J.transpose() * J;
    EXPECT_LE((value->normal - normal).norm(), kHalfDigits * normal.norm() + kHalfDigits);
  }
}

TEST(VariableProjectionTest, ThreadsDoNotChangeABit) {
  ForRandomCases(1e-5, [](RandomSplines&, const Case& c) {
    ThreadPool one(1), three(3);
    const VariableProjection projection(c.problem);
    const auto a = projection.Linearise(c.knots, one), b = projection.Linearise(c.knots, three);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) return;
    EXPECT_EQ(a->cost, b->cost);
    EXPECT_EQ(a->normal, b->normal);
    EXPECT_EQ(a->gradient, b->gradient);
  });
}

TEST(VariableProjectionTest, ErrorsOfSpansAddUpAndTheirCentroidsLieInside) {
  ForRandomCases(0, [](RandomSplines&, const Case& c) {
    ThreadPool pool(2);
    const VariableProjection projection(c.problem);
    const auto value = projection.Evaluate(c.knots, pool);
    const auto errors = projection.Errors(c.knots, pool);
    ASSERT_EQ(value.has_value(), errors.has_value());
    if (!errors) return;
    for (const auto* spans : {&errors->u, &errors->v}) {
      if (spans->empty()) continue;
      double sum = 0;
      for (const auto& span : *spans) {
        sum += span.squares;
        EXPECT_GE(span.centroid, span.lower);
        EXPECT_LE(span.centroid, span.upper);
      }
      EXPECT_NEAR(sum, value->squares, kIterated * projection.squares());
    }
  });
}

TEST(KnotDescentTest, NeverEndsAboveItsStartAndKeepsTheNumberOfKnots) {
  for (const double smoothing : {0.0, 1e-4}) {
    ForRandomCases(smoothing, [](RandomSplines&, const Case& c) {
      ThreadPool pool(1);
      const VariableProjection projection(c.problem);
      const auto value = projection.Evaluate(c.knots, pool);
      const Descent descent = Descend(projection, c.knots, {.max_iterations = 20}, pool);
      ASSERT_EQ(value.has_value(), std::isfinite(descent.cost));
      if (!value) return;
      EXPECT_LE(descent.cost, value->cost * (1 + 1e-4));  // what merging may cost
      EXPECT_EQ(descent.knots.u.basis().size(), c.knots.u.basis().size());
      EXPECT_LE(descent.iterations, 20);
    });
  }
}

TEST(KnotDescentTest, FindsTheKnotsOfASplineFromNearby) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    std::vector<double> breaks = {0, 0.2, 0.45, 0.6, 0.85, 1};
    for (int i = 1; i <= 4; ++i) breaks[i] += random.Real(-0.05, 0.05);
    const SplineBasis basis = SplineBasis::Clamped(3, breaks);
    auto data = std::make_shared<FittingData>();
    data->parameters = Eigen::Matrix2Xd::Zero(2, 400);
    data->parameters.row(0).setLinSpaced(400, 0, 1);
    data->values.resize(1, 400);
    Eigen::MatrixXd coefficients(1, basis.size());
    for (int i = 0; i < basis.size(); ++i)
      coefficients(0, i) = (i % 2 ? 1 : -1) * random.Real(0.5, 1);
    ThreadPool pool(1);
    data->values.setZero();
    data->values = EvaluateAt(FittingProblem(basis, data, 0), coefficients, pool);
    std::vector<double> start = breaks;
    for (int i = 1; i <= 4; ++i) start[i] += random.Real(-0.03, 0.03);
    const VariableProjection projection(FittingProblem(SplineBasis::Clamped(3, start), data, 0));
    const MovingKnots knots{KnotGaps(SplineBasis::Clamped(3, start)), std::nullopt, true, false};
    const Descent descent = Descend(projection, knots, {}, pool);
    ASSERT_EQ(descent.knots.u.groups(), 4);
    for (int g = 0; g < 4; ++g) EXPECT_NEAR(descent.knots.u.knot(g), breaks[g + 1], kHalfDigits);
  }
}

}  // namespace batten::internal::variable_projection_test
