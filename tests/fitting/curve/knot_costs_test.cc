// SPDX-License-Identifier: MIT
#include "fitting/curve/knot_costs.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fitting/linear/coefficient_order.h"
#include "fitting/least_squares/fairness.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/curve/span_layout.h"
#include "geometry/numeric/gauss_rule.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::knot_costs_test {

// The sum that a problem's weight of fairness makes, over any basis: rows of the data, then of the
// energy at the nodes of an exact rule, times the coefficients that differ.
class DenseSum {
 public:
  DenseSum(const FittingProblem& problem, double lambda)
      : data_(problem.data()), basis_(problem.basis_u()), order_(std::min(2, basis_.degree())) {
    const auto count = problem.size();
    const GaussRule rule = GaussLegendre(basis_.degree() + 1);
    const std::vector<int> spans = basis_.Spans();
    rows_ = Eigen::MatrixXd::Zero(
        count + static_cast<Eigen::Index>(spans.size()) * rule.nodes.size(), DistinctCount(basis_));
    right_ = Eigen::MatrixXd::Zero(rows_.rows(), data_.values.rows());
    for (Eigen::Index k = 0; k < count; ++k) {
      const double u = data_.parameters(0, k),
                   root = std::sqrt(data_.weights.size() > 0 ? data_.weights[k] : 1);
      Add(k, basis_.Span(u), u, 0, root);
      right_.row(k) = root * data_.values.col(k).transpose();
    }
    Eigen::Index to = count;
    for (const int span : spans) {
      const double a = basis_.knots()[static_cast<size_t>(span)],
                   b = basis_.knots()[static_cast<size_t>(span) + 1];
      for (Eigen::Index g = 0; g < rule.nodes.size(); ++g) {
        Add(to++,
            span,
            a + (b - a) * rule.nodes[g],
            order_,
            std::sqrt(lambda * rule.weights[g] * (b - a)));
      }
    }
  }

  double Least() const {
    const Eigen::MatrixXd solution = Eigen::HouseholderQR<Eigen::MatrixXd>(rows_).solve(right_);
    return (rows_ * solution - right_).squaredNorm();
  }

 private:
  void Add(Eigen::Index row, int span, double u, int order, double factor) {
    const int p = basis_.degree();
    std::vector<double> values(static_cast<size_t>((order + 1) * (p + 1)));
    basis_.Derivatives(span, u, order, values.data());
    for (int r = 0; r <= p; ++r) {
      rows_(row, (span - p + r) % rows_.cols()) +=
          factor * values[static_cast<size_t>(order * (p + 1) + r)];
    }
  }

  const FittingData& data_;
  const SplineBasis& basis_;
  int order_;
  Eigen::MatrixXd rows_, right_;
};

double Weights(const FittingProblem& problem) {
  return problem.data().weights.size() > 0 ? problem.data().weights.sum()
                                           : static_cast<double>(problem.size());
}

// λ of the header, from the traces over all functions, repeated ones apart.
double Lambda(const FittingProblem& problem) {
  const SplineBasis& basis = problem.basis_u();
  double trace = 0;
  std::vector<double> values(static_cast<size_t>(basis.degree()) + 1);
  for (Eigen::Index k = 0; k < problem.size(); ++k) {
    const double u = problem.data().parameters(0, k);
    basis.Values(basis.Span(u), u, values.data());
    for (const double value : values)
      trace += (problem.data().weights.size() > 0 ? problem.data().weights[k] : 1) * value * value;
  }
  const double energy = DerivativeGram(basis, std::min(2, basis.degree())).col(0).sum();
  return problem.smoothing() * trace / energy;
}

struct Case {
  SpanLayout layout;
  FittingProblem problem;
};

// Spans of comparable lengths, some corners, waves and noise as data.
Case RandomCase(unsigned seed, int degree, bool closed, double smoothing, double unit = 1) {
  RandomSplines random(seed);
  std::vector<double> breaks{random.Real(-2, 2) * unit}, corners;
  const int spans = random.Integer(closed ? degree + 2 : 2, 12);
  for (int k = 0; k < spans; ++k) breaks.push_back(breaks.back() + random.Real(0.5, 1.5) * unit);
  for (int k = closed ? 0 : 1; k < spans; ++k) {
    if (random.Integer(0, 4) == 0) corners.push_back(breaks[static_cast<size_t>(k)]);
  }
  SpanLayout layout(degree, breaks, corners, closed);
  const int count = 15 * layout.control_points(), dimension = random.Integer(1, 3);
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, count);
  data->values.resize(dimension, count);
  for (int k = 0; k < count; ++k) {
    const double u = random.Real(breaks.front(), breaks.back());
    data->parameters(0, k) = u;
    for (int d = 0; d < dimension; ++d)
      data->values(d, k) = std::sin(u / unit * (d + 1)) + random.Real(-0.1, 0.1);
  }
  if (random.Coin()) {
    data->weights.resize(count);
    for (double& w : data->weights) w = random.Integer(0, 4) == 0 ? 0 : random.Real(0.5, 2);
  }
  FittingProblem problem(layout.Basis(), std::move(data), smoothing);
  return {std::move(layout), std::move(problem)};
}

void ForCases(const std::function<void(const Case&)>& law) {
  unsigned seed = 0;
  for (int degree = 1; degree <= 5; ++degree) {
    for (const bool closed : {false, true}) {
      for (const double smoothing : {0.0, 1e-6, 1e-3}) {
        for (int repeat = 0; repeat < 2; ++repeat) {
          ++seed;
          SCOPED_TRACE("seed " + std::to_string(seed) + ", degree " + std::to_string(degree) +
                       ", closed " + std::to_string(closed) + ", smoothing " +
                       std::to_string(smoothing));
          law(RandomCase(seed, degree, closed, smoothing));
          if (testing::Test::HasFailure()) return;
        }
      }
    }
  }
}

// Inner breaks that are no corners.
std::vector<int> Removable(const SpanLayout& layout) {
  std::vector<int> inner;
  for (int k = 1; k < layout.spans(); ++k) {
    if (!layout.IsCorner(k)) inner.push_back(k);
  }
  return inner;
}

std::vector<double> Costs(const FittingProblem& problem, const std::vector<double>& knots) {
  ThreadPool pool(1);
  return RemovalCosts(problem, SolveLinear(problem, pool).coefficients, knots, pool);
}

std::vector<double> Costs(const Case& given) {
  std::vector<double> knots;
  for (const int k : Removable(given.layout))
    knots.push_back(given.layout.breaks()[static_cast<size_t>(k)]);
  return Costs(given.problem, knots);
}

TEST(RemovalCostsTest, AreWhatTheSumRisesByWhenTheKnotIsGone) {
  ForCases([](const Case& given) {
    const std::vector<int> inner = Removable(given.layout);
    const std::vector<double> costs = Costs(given);
    ASSERT_EQ(costs.size(), inner.size());
    const double lambda = Lambda(given.problem), least = DenseSum(given.problem, lambda).Least();
    for (size_t k = 0; k < inner.size(); ++k) {
      const FittingProblem without =
          given.problem.WithBasis(given.layout.Without(inner[k]).Basis());
      const double risen = DenseSum(without, lambda).Least() - least;
      // The rise is the difference of two sums; the cost has the condition of the matrix, below 1e5
      // here.
      EXPECT_NEAR(costs[k], risen, 1e5 * kRounding * risen + kRounding * (least + risen)) << k;
    }
  });
}

// Two layouts of the same closed curve that differ in where they begin.
TEST(RemovalCostsTest, KnowTheSeamAsAKnotLikeAnyOther) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(1, 5), spans = random.Integer(degree + 2, 12);
    const Case given = RandomCase(seed, degree, true, 1e-6);
    std::vector<double> breaks;
    for (int k = 0; k <= spans; ++k) breaks.push_back(k);
    const SpanLayout layout(degree, breaks, {}, true);
    auto data = std::make_shared<FittingData>(given.problem.data());
    const double lower = data->parameters.row(0).minCoeff(),
                 upper = data->parameters.row(0).maxCoeff();
    data->parameters.row(0) = (data->parameters.row(0).array() - lower) / (upper - lower) * spans;
    const FittingProblem problem(layout.Basis(), data, 1e-6);
    const int turn = random.Integer(1, spans - 1);
    Eigen::Matrix2Xd turned = data->parameters;
    for (double& u : turned.row(0)) u += u + turn > spans ? turn - spans : turn;
    const double seam = Costs(problem, {0.0})[0];
    const double inner = Costs(problem.WithParameters(turned), {static_cast<double>(turn)})[0];
    EXPECT_NEAR(seam, inner, 1e5 * kRounding * (seam + inner));
  }
}

TEST(RemovalCostsTest, AreNothingForKnotsThatWereInserted) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(1, 5);
    const Case given = RandomCase(seed, degree, random.Coin(), 0);
    ThreadPool pool(1);
    auto data = std::make_shared<FittingData>(given.problem.data());
    const Eigen::MatrixXd net = SolveLinear(given.problem, pool).coefficients;
    data->values = EvaluateAt(given.problem, net, pool);
    const SpanLayout finer =
        given.layout.Halved(std::vector<bool>(static_cast<size_t>(given.layout.spans()), true));
    const FittingProblem problem(finer.Basis(), data, 0);
    std::vector<double> inserted;
    for (int k = 1; k < finer.spans(); k += 2)
      inserted.push_back(finer.breaks()[static_cast<size_t>(k)]);
    // Squares of coefficients right to 1e-7.
    for (const double cost : Costs(problem, inserted))
      EXPECT_LE(cost, kHalfDigits * kHalfDigits * Weights(problem));
  }
}

TEST(RemovalCostsTest, GoWithTheSquareOfTheUnitAndNotWithThatOfTheParameters) {
  for (int degree = 1; degree <= 7; ++degree) {
    for (const double unit : {1e-6, 1e6}) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", unit " + std::to_string(unit));
      const Case plain = RandomCase(5, degree, degree % 2 == 0, 1e-6);
      const Case scaled = RandomCase(5, degree, degree % 2 == 0, 1e-6, unit);
      auto data = std::make_shared<FittingData>(scaled.problem.data());
      data->values = plain.problem.data().values * unit;
      const std::vector<double> one = Costs(plain),
                                other = Costs({scaled.layout, scaled.problem.WithData(data)});
      ASSERT_EQ(one.size(), other.size());
      double greatest = 0;
      for (const double cost : one) greatest = std::max(greatest, cost);
      for (size_t k = 0; k < one.size(); ++k)
        EXPECT_NEAR(other[k] / (unit * unit), one[k], kHalfDigits * greatest);
    }
  }
}

TEST(RemovalCostsTest, DoNotKnowWhereTheOriginIs) {
  ForCases([](const Case& given) {
    auto data = std::make_shared<FittingData>(given.problem.data());
    data->values.array() += 1000;
    const std::vector<double> here = Costs(given),
                              there = Costs({given.layout, given.problem.WithData(data)});
    // Jumps lose three digits of coefficients, themselves right to the condition.
    for (size_t k = 0; k < here.size(); ++k)
      EXPECT_NEAR(there[k], here[k], kHalfDigits * (here[k] + 1));
  });
}

TEST(RemovalCostsTest, AreNothingWhereThereAreNoKnots) {
  const Case given = RandomCase(1, 3, false, 0);
  EXPECT_TRUE(Costs(given.problem, {}).empty());
}

TEST(RemovalCostsTest, AreTheSameFewOrManyAtATime) {
  std::vector<double> breaks, knots;
  for (int k = 0; k <= 150; ++k) breaks.push_back(k);
  const SpanLayout layout(3, breaks, {}, false);
  RandomSplines random(4);
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, 2000);
  data->values.resize(2, 2000);
  for (double& u : data->parameters.row(0)) u = random.Real(0, 150);
  for (double& z : data->values.reshaped()) z = random.Real(-1, 1);
  const FittingProblem problem(layout.Basis(), data, 1e-8);
  for (int k = 1; k < 150; ++k) knots.push_back(k);
  const std::vector<double> all = Costs(problem, knots);
  for (const size_t k : {0, 63, 64, 100, 148})
    EXPECT_NEAR(Costs(problem, {knots[k]})[0], all[k], kIterated * all[k]);
}

}  // namespace batten::internal::knot_costs_test
