// SPDX-License-Identifier: MIT
// Linear fits around periodic bases against a dense solution.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fitting/linear/coefficient_order.h"
#include "fitting/least_squares/fairness.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "random_splines.h"
#include "tolerances.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/gauss_rule.h"

namespace batten::internal::periodic_problem_test {


LinearSolution Solve(const FittingProblem& problem, int threads = 1) {
  ThreadPool pool(threads);
  return SolveLinear(problem, pool);
}

double Greatest(const Eigen::MatrixXd& matrix) {
  return matrix.size() > 0 ? matrix.cwiseAbs().maxCoeff() : 0;
}

// The p+1 functions' derivatives of every order up to two at u, in a row each of all n.
Eigen::MatrixXd FunctionRows(const SplineBasis& basis, int span, double u) {
  const int p = basis.degree();
  std::vector<double> values(static_cast<size_t>(3 * (p + 1)));
  basis.Derivatives(span, u, 2, values.data());
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, basis.size());
  for (int order = 0; order < 3; ++order) {
    for (int r = 0; r <= p; ++r)
      rows(order, span - p + r) = values[static_cast<size_t>(order * (p + 1) + r)];
  }
  return rows;
}

// Row of the tensor product of u's derivative i and v's derivative j.
Eigen::RowVectorXd Product(const Eigen::MatrixXd& u, int i, const Eigen::MatrixXd& v, int j) {
  Eigen::RowVectorXd row(u.cols() * v.cols());
  for (Eigen::Index k = 0; k < u.cols(); ++k)
    row.segment(k * v.cols(), v.cols()) = u(i, k) * v.row(j);
  return row;
}

// A surface's problem as dense rows; a curve is one whose second basis is the constant.
class DenseProblem {
 public:
  explicit DenseProblem(const FittingProblem& problem) : problem_(problem) {
    const SplineBasis& u = problem.basis_u();
    Eigen::MatrixXd design(problem.size(), problem.net_size());
    for (Eigen::Index k = 0; k < problem.size(); ++k) {
      const double at = problem.data().parameters(0, k);
      design.row(k) = Product(FunctionRows(u, u.Span(at), at), 0, RowsV(k), 0);
    }
    const Eigen::MatrixXd fair = FairnessRows();
    weights_ = problem.data().weights.size() > 0 ? problem.data().weights
                                                 : Eigen::VectorXd::Ones(problem.size());
    const Eigen::MatrixXd weighted = weights_.cwiseSqrt().asDiagonal() * design;
    // Repeated coefficients apart in both traces.
    lambda_ = problem.smoothing() * weighted.squaredNorm() / fair.squaredNorm();
    Distinct();
    design_ = design * spread_;
    rows_.resize(design.rows() + fair.rows(), spread_.cols());
    rows_ << weighted * spread_, std::sqrt(lambda_) * fair * spread_;
  }

  // d × net size, repeated coefficients too.
  Eigen::MatrixXd Solution() const {
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(rows_.rows(), problem_.data().values.rows());
    right.topRows(problem_.size()) =
        weights_.cwiseSqrt().asDiagonal() * problem_.data().values.transpose();
    const Eigen::MatrixXd distinct = Eigen::HouseholderQR<Eigen::MatrixXd>(rows_).solve(right);
    return (spread_ * distinct).transpose();
  }

  double Squares(const Eigen::MatrixXd& coefficients) const {
    const Eigen::MatrixXd points = coefficients * FirstOfEach() * design_.transpose();
    return weights_.dot((points - problem_.data().values).colwise().squaredNorm().transpose());
  }

  // Of the normal matrix.
  double Condition() const {
    const Eigen::VectorXd values =
        Eigen::JacobiSVD<Eigen::MatrixXd>(Eigen::HouseholderQR<Eigen::MatrixXd>(rows_)
                                              .matrixQR()
                                              .topRows(rows_.cols())
                                              .triangularView<Eigen::Upper>()
                                              .toDenseMatrix())
            .singularValues();
    return std::pow(values[0] / values[values.size() - 1], 2);
  }

 private:
  Eigen::MatrixXd RowsV(Eigen::Index k) const {
    if (problem_.is_curve()) return Constant();
    const double at = problem_.data().parameters(1, k);
    return FunctionRows(problem_.basis_v(), problem_.basis_v().Span(at), at);
  }

  static Eigen::MatrixXd Constant() { return Eigen::Vector3d(1, 0, 0); }

  // √weight and functions at the nodes of an exact rule on every span.
  static std::vector<std::pair<double, Eigen::MatrixXd>> Nodes(const SplineBasis& basis) {
    std::vector<std::pair<double, Eigen::MatrixXd>> nodes;
    const GaussRule rule = GaussLegendre(basis.degree() + 1);
    for (const int span : basis.Spans()) {
      const double a = basis.knots()[static_cast<size_t>(span)],
                   b = basis.knots()[static_cast<size_t>(span) + 1];
      for (Eigen::Index g = 0; g < rule.nodes.size(); ++g) {
        nodes.emplace_back(std::sqrt(rule.weights[g] * (b - a)),
                           FunctionRows(basis, span, a + (b - a) * rule.nodes[g]));
      }
    }
    return nodes;
  }

  Eigen::MatrixXd FairnessRows() const {
    const auto nodes_u = Nodes(problem_.basis_u());
    auto nodes_v = problem_.is_curve()
                       ? std::vector<std::pair<double, Eigen::MatrixXd>>{{1.0, Constant()}}
                       : Nodes(problem_.basis_v());
    const int least = problem_.is_curve()
                          ? problem_.basis_u().degree()
                          : std::min(problem_.basis_u().degree(), problem_.basis_v().degree());
    struct Term {
      double factor;
      int u, v;
    };
    std::vector<Term> terms{{1, 2, 0}, {std::sqrt(2.0), 1, 1}, {1, 0, 2}};
    if (least == 1) terms = {{1, 1, 0}, {1, 0, 1}};
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(nodes_u.size() * nodes_v.size() * terms.size()),
                         problem_.net_size());
    Eigen::Index to = 0;
    for (const auto& [weight_u, u] : nodes_u) {
      for (const auto& [weight_v, v] : nodes_v) {
        for (const Term& term : terms)
          rows.row(to++) = term.factor * weight_u * weight_v * Product(u, term.u, v, term.v);
      }
    }
    return rows;
  }

  // One column for each different coefficient, a one in every row that repeats it: coefficient i of
  // a periodic basis is the (i − (n − p))-th again.
  void Distinct() {
    const auto round = [](const SplineBasis& basis) {
      return basis.periodic() ? basis.size() - basis.degree() : basis.size();
    };
    const SplineBasis& u = problem_.basis_u();
    const int size_v = problem_.is_curve() ? 1 : problem_.basis_v().size(),
              round_v = problem_.is_curve() ? 1 : round(problem_.basis_v()), round_u = round(u);
    spread_ = Eigen::MatrixXd::Zero(problem_.net_size(), round_u * round_v);
    for (int i = 0; i < u.size(); ++i) {
      for (int j = 0; j < size_v; ++j)
        spread_(i * size_v + j, i % round_u * round_v + j % round_v) = 1;
    }
  }

  // Takes the first of each group of repeated coefficients.
  Eigen::MatrixXd FirstOfEach() const {
    Eigen::MatrixXd first = Eigen::MatrixXd::Zero(spread_.rows(), spread_.cols());
    for (Eigen::Index c = 0; c < spread_.cols(); ++c) {
      Eigen::Index row = 0;
      spread_.col(c).maxCoeff(&row);
      first(row, c) = 1;
    }
    return first;
  }

  const FittingProblem& problem_;
  Eigen::VectorXd weights_;
  double lambda_ = 0;
  Eigen::MatrixXd design_, spread_, rows_;
};

// A periodic basis of `distinct` functions, its spans even or uneven by a factor of four at most.
SplineBasis Around(RandomSplines& random, int degree, int distinct) {
  std::vector<double> breaks{random.Real(-2, 2)};
  const bool even = random.Coin();
  const double length = random.Real(0.2, 1);
  for (int k = 0; k < distinct; ++k)
    breaks.push_back(breaks.back() + length * (even ? 1 : random.Real(0.5, 2)));
  std::vector<double> knots;
  const double period = breaks.back() - breaks.front();
  const auto at = [&](int k) {
    const int turns = static_cast<int>(std::floor(static_cast<double>(k) / distinct));
    return breaks[static_cast<size_t>(k - turns * distinct)] + turns * period;
  };
  for (int k = -degree; k <= distinct + degree; ++k) knots.push_back(at(k));
  return SplineBasis::Periodic(degree, std::move(knots));
}

std::shared_ptr<FittingData> RandomData(
    RandomSplines& random, const SplineBasis& u, const SplineBasis* v, int count, int dimension) {
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, count);
  for (int k = 0; k < count; ++k) {
    data->parameters(0, k) = k == 0   ? u.lower()
                             : k == 1 ? u.upper()
                                      : random.Real(u.lower(), u.upper());
    if (v) {
      data->parameters(1, k) = k == 2   ? v->lower()
                               : k == 3 ? v->upper()
                                        : random.Real(v->lower(), v->upper());
    }
  }
  data->values.resize(dimension, count);
  for (double& z : data->values.reshaped()) z = random.Real(-1, 1);
  if (random.Coin()) {
    data->weights.resize(count);
    for (double& w : data->weights) w = random.Integer(0, 4) == 0 ? 0 : random.Real(0.5, 2);
  }
  return data;
}

constexpr double kSmoothings[] = {0, 1e-6, 1e-2};

// Curves of every degree to seven around few and many functions.
void ForPeriodicCurves(const std::function<void(const FittingProblem&)>& law) {
  unsigned seed = 0;
  for (int degree = 1; degree <= 7; ++degree) {
    for (const int distinct : {1, 2, degree, degree + 1, 2 * degree, 2 * degree + 1, 25}) {
      for (const double smoothing : kSmoothings) {
        RandomSplines random(++seed);
        SCOPED_TRACE("seed " + std::to_string(seed) + ", degree " + std::to_string(degree) + ", " +
                     std::to_string(distinct) + " functions, smoothing " +
                     std::to_string(smoothing));
        const SplineBasis basis = Around(random, degree, distinct);
        auto data =
            RandomData(random, basis, nullptr, 12 * distinct + 12, 1 + static_cast<int>(seed % 3));
        law(FittingProblem(basis, std::move(data), smoothing));
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

// Surfaces periodic in u, in v and in both, the larger direction first or second.
void ForPeriodicSurfaces(const std::function<void(const FittingProblem&)>& law) {
  for (unsigned seed = 0; seed < 36; ++seed) {
    RandomSplines random(seed);
    SCOPED_TRACE("seed " + std::to_string(seed));
    const auto basis = [&](bool around, bool large) {
      const int degree = random.Integer(1, 4);
      const int functions = large ? random.Integer(8, 10) : random.Integer(1, 4);
      return around ? Around(random, degree, functions)
                    : SplineBasis::Uniform(degree, degree + functions, -1, 1);
    };
    const int kind = static_cast<int>(seed % 3);
    const bool u_large = seed / 3 % 2 == 0;
    const SplineBasis u = basis(kind != 1, u_large), v = basis(kind != 0, !u_large);
    auto data = RandomData(random, u, &v, 8 * u.size() * v.size(), random.Coin() ? 1 : 3);
    law(FittingProblem(u, v, std::move(data), kSmoothings[seed / 6 % 3]));
    if (testing::Test::HasFailure()) return;
  }
}

// Normal equations lose the condition of their matrix, times what rounding does to sums of some
// hundred terms, and four roundings that keep the matrix definite.
double Bound(const DenseProblem& dense) { return 100 * kEpsilon * dense.Condition(); }

void ExpectDenseSolution(const FittingProblem& problem) {
  const DenseProblem dense(problem);
  const LinearSolution solution = Solve(problem);
  EXPECT_FALSE(solution.regularised);
  const Eigen::MatrixXd expected = dense.Solution();
  ASSERT_EQ(solution.coefficients.cols(), expected.cols());
  EXPECT_LE(Greatest(solution.coefficients - expected), Bound(dense) * Greatest(expected));
  const double squares = dense.Squares(solution.coefficients);
  EXPECT_NEAR(solution.residual_squares, squares, kIterated * squares);
}

TEST(PeriodicCurveProblemTest, HasTheSolutionOfDenseLeastSquares) {
  ForPeriodicCurves(ExpectDenseSolution);
}

TEST(PeriodicSurfaceProblemTest, HasTheSolutionOfDenseLeastSquares) {
  ForPeriodicSurfaces(ExpectDenseSolution);
}

void ExpectRepeats(const FittingProblem& problem) {
  const LinearSolution solution = Solve(problem);
  const SplineBasis& u = problem.basis_u();
  const SplineBasis* v = problem.is_curve() ? nullptr : &problem.basis_v();
  const int size_v = v ? v->size() : 1;
  const auto first = [](const SplineBasis& basis, int i) {
    return basis.periodic() ? i % (basis.size() - basis.degree()) : i;
  };
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < size_v; ++j) {
      const int from = first(u, i) * size_v + (v ? first(*v, j) : 0);
      EXPECT_EQ(solution.coefficients.col(i * size_v + j), solution.coefficients.col(from));
    }
  }
}

TEST(PeriodicCurveProblemTest, RepeatsTheFirstCoefficientsBitForBit) {
  ForPeriodicCurves(ExpectRepeats);
}

TEST(PeriodicSurfaceProblemTest, RepeatsTheFirstCoefficientsBitForBit) {
  ForPeriodicSurfaces(ExpectRepeats);
}

// Values of a random net that repeats as it must.
void ExpectRecovery(const FittingProblem& given) {
  RandomSplines random(3);
  const LinearSolution pattern = Solve(given);
  const std::vector<int> u = DistinctIndices(&given.basis_u()),
                         v = DistinctIndices(given.is_curve() ? nullptr : &given.basis_v());
  Eigen::MatrixXd net(pattern.coefficients.rows(), pattern.coefficients.cols());
  for (size_t i = 0; i < u.size(); ++i) {
    for (size_t j = 0; j < v.size(); ++j) {
      const auto to = static_cast<Eigen::Index>(i * v.size() + j);
      const auto from = static_cast<Eigen::Index>(static_cast<size_t>(u[i]) * v.size()) + v[j];
      if (from < to) {
        net.col(to) = net.col(from);
      } else {
        for (double& c : net.col(to)) c = random.Real(-1, 1);
      }
    }
  }
  ThreadPool pool(1);
  auto data = std::make_shared<FittingData>(given.data());
  data->values = EvaluateAt(given, net, pool);
  const FittingProblem problem = given.is_curve()
                                     ? FittingProblem(given.basis_u(), data, 0)
                                     : FittingProblem(given.basis_u(), given.basis_v(), data, 0);
  const LinearSolution solution = Solve(problem);
  const double bound = Bound(DenseProblem(problem));
  EXPECT_LE(Greatest(solution.coefficients - net), bound);
  // Of coefficients that wrong, and to rounding where they are better.
  EXPECT_LE(solution.residual_squares, static_cast<double>(problem.size()) * bound * bound);
}

TEST(PeriodicCurveProblemTest, RecoversTheCurveThatTheDataWereTakenFrom) {
  ForPeriodicCurves(ExpectRecovery);
}

TEST(PeriodicSurfaceProblemTest, RecoversTheSurfaceThatTheDataWereTakenFrom) {
  ForPeriodicSurfaces(ExpectRecovery);
}

TEST(PeriodicCurveProblemTest, HasAllDerivativesButTheLastAtTheSeam) {
  ForPeriodicCurves([](const FittingProblem& problem) {
    const LinearSolution solution = Solve(problem);
    const SplineBasis& basis = problem.basis_u();
    const int p = basis.degree();
    const auto derivatives = [&](int span, double u) {
      std::vector<double> values(static_cast<size_t>((p + 1) * (p + 1)));
      basis.Derivatives(span, u, p, values.data());
      const Eigen::Map<const Eigen::MatrixXd> functions(values.data(), p + 1, p + 1);
      return Eigen::MatrixXd(solution.coefficients.middleCols(span - p, p + 1) * functions);
    };
    const int first = basis.Spans().front(), last = basis.Spans().back();
    const Eigen::MatrixXd before = derivatives(last, basis.upper()),
                          after = derivatives(first, basis.lower());
    double shortest = basis.upper() - basis.lower();
    for (const int span : basis.Spans()) {
      shortest = std::min(
          shortest,
          basis.knots()[static_cast<size_t>(span) + 1] - basis.knots()[static_cast<size_t>(span)]);
    }
    double scale = Greatest(solution.coefficients) + kEpsilon;
    for (int order = 0; order < p; ++order) {
      EXPECT_LE(Greatest(before.col(order) - after.col(order)), kRounding * scale) << order;
      scale *= 2 * (p - order) / shortest;
    }
  });
}

TEST(PeriodicCurveProblemTest, GivesTheSameBitsForEveryNumberOfThreads) {
  ForPeriodicCurves([](const FittingProblem& problem) {
    EXPECT_EQ(Solve(problem, 3).coefficients, Solve(problem, 1).coefficients);
  });
}

// Turning the parameters by some spans of an even basis turns the coefficients by as many.
TEST(PeriodicCurveProblemTest, DoesNotKnowWhereTheSeamIs) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(1, 7), distinct = random.Integer(1, 20),
              turn = random.Integer(0, distinct);
    std::vector<double> knots;
    for (int k = -degree; k <= distinct + degree; ++k) knots.push_back(k);
    const SplineBasis basis = SplineBasis::Periodic(degree, knots);
    const auto data = RandomData(random, basis, nullptr, 20 * distinct, 2);
    const FittingProblem problem(basis, data, 1e-4);
    Eigen::Matrix2Xd turned = data->parameters;
    for (double& u : turned.row(0)) u += u + turn > distinct ? turn - distinct : turn;
    const Eigen::MatrixXd here = Solve(problem).coefficients,
                          there = Solve(problem.WithParameters(turned)).coefficients;
    // Parameters are rounded by the turn, which the condition, below 1e5 here, makes larger.
    for (int i = 0; i < distinct; ++i) {
      EXPECT_LE(Greatest(there.col((i + turn) % distinct) - here.col(i)), 1e5 * kRounding);
    }
  }
}

TEST(PeriodicCurveProblemTest, CarriesEmptySpansByFairnessAndSaysWhereThereIsNone) {
  for (int degree = 2; degree <= 5; ++degree) {
    for (const double smoothing : {0.0, 1e-6}) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", smoothing " + std::to_string(smoothing));
      RandomSplines random(7);
      const SplineBasis basis = Around(random, degree, 14);
      auto data = std::make_shared<FittingData>();
      data->parameters = Eigen::Matrix2Xd::Zero(2, 400);
      data->values = Eigen::MatrixXd::Constant(2, 400, 1);
      // Nothing in three fifths of the domain, around the seam.
      for (double& u : data->parameters.row(0))
        u = basis.lower() + random.Real(0.3, 0.7) * (basis.upper() - basis.lower());
      const LinearSolution solution = Solve(FittingProblem(basis, data, smoothing));
      EXPECT_EQ(solution.regularised, smoothing == 0);
      ASSERT_TRUE(solution.coefficients.allFinite());
      // A constant costs nothing.
      if (smoothing > 0) {
        EXPECT_LE(Greatest((solution.coefficients.array() - 1).matrix()), kHalfDigits);
      }
    }
  }
}

TEST(CoefficientOrderTest, IsAPermutationThatRepeatsWithTheCoefficients) {
  RandomSplines random(1);
  for (int degree = 1; degree <= 7; ++degree) {
    for (int distinct = 1; distinct <= 30; ++distinct) {
      for (const bool around : {true, false}) {
        if (!around && distinct <= degree) continue;
        SCOPED_TRACE("degree " + std::to_string(degree) + ", " + std::to_string(distinct));
        const SplineBasis basis = around ? Around(random, degree, distinct)
                                         : SplineBasis::Uniform(degree, distinct, 0, 1);
        const CoefficientOrder order(basis);
        ASSERT_EQ(order.count(), distinct);
        ASSERT_EQ(DistinctCount(basis), distinct);
        const std::vector<int> rows = order.Rows(basis), indices = DistinctIndices(&basis);
        ASSERT_EQ(static_cast<int>(rows.size()), basis.size());
        std::vector<int> first(rows.begin(), rows.begin() + distinct);
        std::sort(first.begin(), first.end());
        for (int i = 0; i < distinct; ++i) EXPECT_EQ(first[static_cast<size_t>(i)], i);
        for (size_t i = 0; i < rows.size(); ++i) {
          EXPECT_EQ(indices[i], static_cast<int>(i) % distinct);
          EXPECT_EQ(rows[i], rows[i % static_cast<size_t>(distinct)]);
          // Functions that meet on a span are neighbours in the band.
          for (size_t j = i; j < std::min(rows.size(), i + static_cast<size_t>(degree) + 1); ++j)
            EXPECT_LE(std::abs(rows[i] - rows[j]), order.bandwidth());
        }
      }
    }
  }
}

TEST(CoefficientOrderTest, HasOneCoefficientWithoutABasis) {
  EXPECT_EQ(DistinctIndices(nullptr), std::vector<int>{0});
}

}  // namespace batten::internal::periodic_problem_test
