// SPDX-License-Identifier: MIT
#include "batten/fitting/fitting_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/solve_linear.h"
#include "batten/geometry/nurbs_surface.h"
#include "random_splines.h"
#include "tolerances.h"
#include "refusal.h"

namespace batten::internal::fitting_problem_test {

using testing::HasSubstr;

// A least-squares solution loses the condition number of the normal matrix; the cases here keep it
// below 1e5, several points to a cell of similar size.
constexpr double kConditioned = 1e5 * kRounding;

std::shared_ptr<FittingData> RandomData(
    RandomSplines& random, const SplineBasis& u, const SplineBasis& v, int count, int dimension) {
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, count);
  data->values.resize(dimension, count);
  for (auto parameter : data->parameters.colwise()) {
    parameter << random.Real(u.lower(), u.upper()), random.Real(v.lower(), v.upper());
  }
  for (double& z : data->values.reshaped()) z = random.Real(-1, 1);
  return data;
}

// Uniform knots and many points a cell, of one dimension or three, weighted or not.
FittingProblem RandomProblem(unsigned seed, double smoothing) {
  RandomSplines random(seed);
  const auto basis = [&] {
    const int degree = random.Integer(1, 4);
    return SplineBasis::Uniform(
        degree, degree + random.Integer(1, 6), random.Real(-2, 0), random.Real(1, 3));
  };
  const SplineBasis u = basis(), v = basis();
  auto data = RandomData(random, u, v, 40 * u.size() * v.size(), random.Coin() ? 1 : 3);
  if (random.Coin()) {
    data->weights.resize(data->values.cols());
    for (double& w : data->weights) w = random.Integer(0, 4) == 0 ? 0 : random.Real(0.5, 2);
  }
  return FittingProblem(u, v, std::move(data), smoothing);
}

void ForRandomProblems(double smoothing, const std::function<void(const FittingProblem&)>& law) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    law(RandomProblem(seed, smoothing));
    if (testing::Test::HasFailure()) return;
  }
}

LinearSolution Solve(const FittingProblem& problem, int threads = 1) {
  ThreadPool pool(threads);
  return SolveLinear(problem, pool);
}

Eigen::MatrixXd Evaluate(const FittingProblem& problem, const Eigen::MatrixXd& coefficients) {
  ThreadPool pool(1);
  return EvaluateAt(problem, coefficients, pool);
}

FittingProblem WithValues(const FittingProblem& problem, Eigen::MatrixXd values) {
  auto data = std::make_shared<FittingData>(problem.data());
  data->values = std::move(values);
  return FittingProblem(problem.basis_u(), problem.basis_v(), std::move(data), problem.smoothing());
}

Eigen::VectorXd Weights(const FittingProblem& problem) {
  return problem.data().weights.size() > 0 ? problem.data().weights
                                           : Eigen::VectorXd::Ones(problem.size());
}

double DirectSquares(const FittingProblem& problem, const Eigen::MatrixXd& coefficients) {
  const Eigen::MatrixXd residuals = Evaluate(problem, coefficients) - problem.data().values;
  return Weights(problem).dot(residuals.colwise().squaredNorm().transpose());
}

double Difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() ? (a - b).cwiseAbs().maxCoeff()
                                                      : std::numeric_limits<double>::infinity();
}

SplineBasis Scaled(const SplineBasis& basis, double unit) {
  std::vector<double> knots = basis.knots();
  for (double& knot : knots) knot *= unit;
  return SplineBasis(basis.degree(), std::move(knots));
}

TEST(EvaluateAtTest, IsTheValueOfTheSurfaceOfThoseControlPoints) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = random.Surface(
        random.Integer(1, 5), random.Integer(1, 5), false, {.clamped = random.Coin()});
    auto data = std::make_shared<FittingData>();
    data->parameters.resize(2, 100);
    data->values = Eigen::MatrixXd::Zero(3, 100);
    for (auto uv : data->parameters.colwise()) {
      uv << random.Parameter(surface.basis_u()), random.Parameter(surface.basis_v());
    }
    const Eigen::Matrix2Xd uv = data->parameters;
    const FittingProblem problem(surface.basis_u(), surface.basis_v(), std::move(data), 0);
    const Eigen::MatrixXd values = Evaluate(problem, surface.control_points());
    for (Eigen::Index k = 0; k < 100; ++k) {
      EXPECT_LE(Difference(values.col(k), surface.At(uv(0, k), uv(1, k))), kRounding);
    }
  }
}

TEST(SolveLinearTest, RecoversTheSplineThatTheDataWereTakenFrom) {
  ForRandomProblems(0, [](const FittingProblem& given) {
    RandomSplines random(1);
    Eigen::MatrixXd net(given.data().values.rows(), given.unknowns());
    for (double& c : net.reshaped()) c = random.Real(-1, 1);
    const FittingProblem problem = WithValues(given, Evaluate(given, net));
    const LinearSolution solution = Solve(problem);
    EXPECT_FALSE(solution.regularised);
    EXPECT_LE(Difference(solution.coefficients, net), kConditioned);
    EXPECT_LE(solution.residual_squares, kConditioned * Weights(problem).sum());
  });
}

TEST(SolveLinearTest, RecoversPlanesWhateverTheSmoothing) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const SplineBasis u = SplineBasis::Uniform(random.Integer(2, 4), 8, -1, 1);
    const SplineBasis v = SplineBasis::Uniform(random.Integer(2, 4), 9, 0, 3);
    auto data = RandomData(random, u, v, 500, 1);
    data->values = 2 * data->parameters.row(0) - 0.5 * data->parameters.row(1);
    const FittingProblem problem(u, v, std::move(data), random.Logarithmic(1e-6, 1e3));
    EXPECT_LE(Difference(Evaluate(problem, Solve(problem).coefficients), problem.data().values),
              kConditioned);
  }
}

TEST(SolveLinearTest, LeavesTheSquaresThatADirectSumFinds) {
  for (const double smoothing : {0.0, 1e-4, 1.0}) {
    ForRandomProblems(smoothing, [](const FittingProblem& problem) {
      const LinearSolution solution = Solve(problem);
      const double expected = DirectSquares(problem, solution.coefficients);
      EXPECT_NEAR(solution.residual_squares, expected, kIterated * expected);
    });
  }
}

TEST(SolveLinearTest, LeavesTheSquaresThatADirectSumFindsEvenWhereTheyAreTiny) {
  ForRandomProblems(0, [](const FittingProblem& given) {
    RandomSplines random(2);
    Eigen::MatrixXd net(given.data().values.rows(), given.unknowns());
    for (double& c : net.reshaped()) c = random.Real(-1, 1);
    // Noise of 1e-9 beside values of 1: the difference of sums of squares keeps nothing of it.
    const FittingProblem problem =
        WithValues(given, Evaluate(given, net) + 1e-9 * given.data().values);
    const LinearSolution solution = Solve(problem);
    const double expected = DirectSquares(problem, solution.coefficients);
    EXPECT_NEAR(solution.residual_squares, expected, 0.01 * expected);
  });
}

TEST(SolveLinearTest, FindsTheLeastSquares) {
  ForRandomProblems(0, [](const FittingProblem& problem) {
    RandomSplines random(3);
    const LinearSolution solution = Solve(problem);
    const double least = DirectSquares(problem, solution.coefficients);
    for (int trial = 0; trial < 5; ++trial) {
      Eigen::MatrixXd other = solution.coefficients;
      for (double& c : other.reshaped()) c += random.Real(-0.01, 0.01);
      EXPECT_GT(DirectSquares(problem, other), least);
    }
  });
}

TEST(SolveLinearTest, LeavesMoreSquaresTheMoreItSmooths) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    double previous = 0;
    for (const double smoothing : {0.0, 1e-6, 1e-4, 1e-2, 1.0}) {
      const double squares = Solve(RandomProblem(seed, smoothing)).residual_squares;
      EXPECT_GE(squares, previous * (1 - kIterated)) << "smoothing " << smoothing;
      previous = squares;
    }
  }
}

TEST(SolveLinearTest, TransposesItsSolutionWithTheParameters) {
  ForRandomProblems(1e-4, [](const FittingProblem& problem) {
    auto data = std::make_shared<FittingData>(problem.data());
    data->parameters = problem.data().parameters.colwise().reverse().eval();
    const FittingProblem turned(
        problem.basis_v(), problem.basis_u(), std::move(data), problem.smoothing());
    const Eigen::MatrixXd a = Solve(problem).coefficients, b = Solve(turned).coefficients;
    const int nu = problem.basis_u().size(), nv = problem.basis_v().size();
    for (int i = 0; i < nu; ++i) {
      for (int j = 0; j < nv; ++j) {
        EXPECT_LE(Difference(a.col(i * nv + j), b.col(j * nu + i)), kConditioned) << i << ", " << j;
      }
    }
  });
}

TEST(SolveLinearTest, ScalesWithTheValues) {
  ForRandomProblems(1e-4, [](const FittingProblem& problem) {
    const LinearSolution one = Solve(problem);
    for (const double unit : {-1e-6, 3.0, 1e6}) {
      const LinearSolution other = Solve(WithValues(problem, unit * problem.data().values));
      EXPECT_LE(Difference(other.coefficients, unit * one.coefficients),
                kConditioned * std::abs(unit));
      EXPECT_NEAR(other.residual_squares,
                  unit * unit * one.residual_squares,
                  kIterated * other.residual_squares);
    }
  });
}

TEST(SolveLinearTest, DoesNotChangeWhenAllWeightsGrowAlike) {
  ForRandomProblems(1e-4, [](const FittingProblem& problem) {
    const LinearSolution one = Solve(problem);
    for (const double factor : {1e-6, 3.0, 1e6}) {
      const LinearSolution other = Solve(problem.WithWeights(factor * Weights(problem)));
      EXPECT_LE(Difference(other.coefficients, one.coefficients), kConditioned)
          << "factor " << factor;
    }
  });
}

TEST(SolveLinearTest, DoesNotDependOnTheUnitOfLength) {
  ForRandomProblems(1e-4, [](const FittingProblem& problem) {
    const LinearSolution one = Solve(problem);
    for (const double unit : {1e-6, 25.4, 1e6}) {
      auto data = std::make_shared<FittingData>(problem.data());
      data->parameters *= unit;
      data->values *= unit;
      const FittingProblem other(Scaled(problem.basis_u(), unit),
                                 Scaled(problem.basis_v(), unit),
                                 std::move(data),
                                 problem.smoothing());
      EXPECT_LE(Difference(Solve(other).coefficients, unit * one.coefficients), kConditioned * unit)
          << "unit " << unit;
    }
  });
}

TEST(SolveLinearTest, DoesNotCareHowManyTimesEveryPointIsGiven) {
  ForRandomProblems(1e-4, [](const FittingProblem& problem) {
    auto twice = std::make_shared<FittingData>();
    twice->parameters = problem.data().parameters.replicate(1, 2);
    twice->values = problem.data().values.replicate(1, 2);
    twice->weights = problem.data().weights.replicate(2, 1);
    const FittingProblem other(
        problem.basis_u(), problem.basis_v(), std::move(twice), problem.smoothing());
    EXPECT_LE(Difference(Solve(other).coefficients, Solve(problem).coefficients), kConditioned);
  });
}

TEST(SolveLinearTest, GivesTheSameBitsForEveryNumberOfThreads) {
  ForRandomProblems(1e-4, [](const FittingProblem& problem) {
    const LinearSolution one = Solve(problem, 1);
    for (const int threads : {2, 3}) {
      const LinearSolution more = Solve(problem, threads);
      EXPECT_EQ(more.coefficients, one.coefficients);
      EXPECT_EQ(more.residual_squares, one.residual_squares);
    }
  });
}

// Heights of 1000 to 1002 over the unit square but for a hole many cells wide.
FittingProblem WithHole(int degree, double smoothing) {
  RandomSplines random(4);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, 2000);
  data->values.resize(1, 2000);
  for (Eigen::Index k = 0; k < 2000;) {
    const double u = random.Real(0, 1), v = random.Real(0, 1);
    if (std::abs(u - 0.5) < 0.3 && std::abs(v - 0.5) < 0.3) continue;
    data->parameters.col(k) << u, v;
    data->values(0, k++) = 1000 + u + v;
  }
  const SplineBasis basis = SplineBasis::Uniform(degree, 14, 0, 1);
  return FittingProblem(basis, basis, std::move(data), smoothing);
}

TEST(SolveLinearTest, BridgesEmptyCellsByFairness) {
  for (const int degree : {2, 3}) {
    SCOPED_TRACE("degree " + std::to_string(degree));
    const LinearSolution solution = Solve(WithHole(degree, 1e-4));
    EXPECT_FALSE(solution.regularised);
    ASSERT_TRUE(solution.coefficients.allFinite());
    // Data of a plane, and the plane costs nothing: it goes through the hole.
    EXPECT_LE(solution.coefficients.maxCoeff(), 1002 + kHalfDigits);
    EXPECT_GE(solution.coefficients.minCoeff(), 1000 - kHalfDigits);
  }
}

TEST(SolveLinearTest, BridgesEmptyCellsWithoutSmoothingTooAndSaysSo) {
  for (const int degree : {1, 2, 3}) {
    SCOPED_TRACE("degree " + std::to_string(degree));
    const LinearSolution solution = Solve(WithHole(degree, 0));
    EXPECT_TRUE(solution.regularised);
    ASSERT_TRUE(solution.coefficients.allFinite());
    EXPECT_LE(solution.coefficients.maxCoeff(), 1010);
    EXPECT_GE(solution.coefficients.minCoeff(), 990);
  }
}

TEST(SolveLinearTest, SaysWhenOnePointIsToCarryASurface) {
  RandomSplines random(5);
  const SplineBasis basis = SplineBasis::Uniform(3, 6, 0, 1);
  const FittingProblem problem(basis, basis, RandomData(random, basis, basis, 1, 3), 0);
  const LinearSolution solution = Solve(problem);
  EXPECT_TRUE(solution.regularised);
  EXPECT_TRUE(solution.coefficients.allFinite());
}

TEST(FittingProblemTest, SharesItsDataWithProblemsOverOtherBases) {
  const FittingProblem problem = RandomProblem(1, 1e-3);
  const SplineBasis u =
      SplineBasis::Uniform(5, 9, problem.basis_u().lower(), problem.basis_u().upper());
  const FittingProblem other = problem.WithBases(u, problem.basis_v());
  EXPECT_EQ(&other.data(), &problem.data());
  EXPECT_EQ(other.basis_u(), u);
  EXPECT_EQ(other.smoothing(), problem.smoothing());
  EXPECT_EQ(other.unknowns(), 9 * problem.basis_v().size());
}

TEST(FittingProblemTest, RefusesSizesThatDoNotAgree) {
  const SplineBasis basis = SplineBasis::Uniform(2, 4, 0, 1);
  RandomSplines random(6);
  const auto refusal = [&](const std::function<void(FittingData&)>& spoil) {
    const auto data = RandomData(random, basis, basis, 10, 1);
    spoil(*data);
    return RefusalOf([&] { FittingProblem(basis, basis, data, 0); });
  };
  EXPECT_EQ(refusal([](FittingData&) {}), "accepted");
  EXPECT_THAT(refusal([](FittingData& d) { d.values.resize(1, 9); }), HasSubstr("values"));
  EXPECT_THAT(refusal([](FittingData& d) { d.weights.setOnes(11); }), HasSubstr("weights"));
}

TEST(FittingProblemTest, RefusesWhatIsNotFinite) {
  const SplineBasis basis = SplineBasis::Uniform(2, 4, 0, 1);
  RandomSplines random(7);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (int place = 0; place < 10; ++place) {
      const auto refusal = [&](const std::function<void(FittingData&)>& spoil) {
        const auto data = RandomData(random, basis, basis, 10, 1);
        data->weights.setOnes(10);
        spoil(*data);
        return RefusalOf([&] { FittingProblem(basis, basis, data, 0); });
      };
      EXPECT_NE(refusal([&](FittingData& d) { d.parameters(0, place) = bad; }), "accepted") << bad;
      EXPECT_NE(refusal([&](FittingData& d) { d.values(0, place) = bad; }), "accepted") << bad;
      EXPECT_NE(refusal([&](FittingData& d) { d.weights[place] = bad; }), "accepted") << bad;
    }
    EXPECT_THAT(
        RefusalOf([&] { FittingProblem(basis, basis, RandomData(random, basis, basis, 5, 1), bad); }),
        HasSubstr("smoothing"));
  }
}

TEST(FittingProblemTest, RefusesNegativeWeightsAndSmoothing) {
  const SplineBasis basis = SplineBasis::Uniform(2, 4, 0, 1);
  RandomSplines random(8);
  const auto data = RandomData(random, basis, basis, 3, 1);
  EXPECT_THAT(RefusalOf([&] { FittingProblem(basis, basis, data, -1e-9); }), HasSubstr("smoothing"));
  const FittingProblem problem(basis, basis, data, 0);
  EXPECT_THAT(RefusalOf([&] { problem.WithWeights(Eigen::Vector3d(1, -1, 1)); }),
              HasSubstr("weight"));
}

TEST(FittingProblemTest, RefusesParametersOutsideTheDomain) {
  const SplineBasis basis = SplineBasis::Uniform(2, 4, 0, 1);
  RandomSplines random(9);
  for (const double bad : {std::nextafter(0.0, -1.0), std::nextafter(1.0, 2.0)}) {
    for (const int row : {0, 1}) {
      const auto data = RandomData(random, basis, basis, 10, 1);
      data->parameters(row, 4) = bad;
      EXPECT_THAT(RefusalOf([&] { FittingProblem(basis, basis, data, 0); }), HasSubstr("domain"));
    }
  }
}

TEST(FittingProblemTest, RefusesToBeWithoutData) {
  const SplineBasis basis = SplineBasis::Uniform(2, 4, 0, 1);
  EXPECT_THAT(RefusalOf([&] { FittingProblem(basis, basis, nullptr, 0); }), HasSubstr("data"));
}

// A curve's problem, many points a span, of one to three dimensions, weighted or not.
FittingProblem RandomCurveProblem(unsigned seed, double smoothing) {
  RandomSplines random(seed);
  const int degree = random.Integer(1, 4);
  const SplineBasis basis = SplineBasis::Uniform(
      degree, degree + random.Integer(1, 8), random.Real(-2, 0), random.Real(1, 3));
  auto data = RandomData(random, basis, basis, 40 * basis.size(), random.Integer(1, 3));
  data->parameters.row(1).setZero();
  if (random.Coin()) {
    data->weights.resize(data->values.cols());
    for (double& w : data->weights) w = random.Integer(0, 4) == 0 ? 0 : random.Real(0.5, 2);
  }
  return FittingProblem(basis, std::move(data), smoothing);
}

void ForRandomCurves(double smoothing, const std::function<void(const FittingProblem&)>& law) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    law(RandomCurveProblem(seed, smoothing));
    if (testing::Test::HasFailure()) return;
  }
}

// Row k has the functions at parameter k.
Eigen::MatrixXd DesignMatrix(const FittingProblem& curve) {
  const SplineBasis& basis = curve.basis_u();
  Eigen::MatrixXd design(curve.size(), basis.size());
  for (Eigen::Index k = 0; k < curve.size(); ++k) {
    for (int i = 0; i < basis.size(); ++i)
      design(k, i) = basis.Function(i, curve.data().parameters(0, k));
  }
  return design;
}

// ∫ N_i″ N_j″ by Simpson's rule on 64 parts a span; of degree one ∫ N_i′ N_j′.
Eigen::MatrixXd EnergyMatrix(const SplineBasis& basis) {
  const int order = std::min(2, basis.degree()), n = basis.size(), p = basis.degree();
  Eigen::MatrixXd energy = Eigen::MatrixXd::Zero(n, n);
  std::vector<double> values(static_cast<size_t>((order + 1) * (p + 1)));
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[span], h = (basis.knots()[span + 1] - a) / 64;
    for (int k = 0; k <= 64; ++k) {
      basis.Derivatives(span, a + h * k, order, values.data());
      const double weight = (k == 0 || k == 64 ? 1 : k % 2 == 1 ? 4 : 2) * h / 3;
      const Eigen::Map<const Eigen::VectorXd> d(values.data() + order * (p + 1), p + 1);
      energy.block(span - p, span - p, p + 1, p + 1) += weight * d * d.transpose();
    }
  }
  return energy;
}

TEST(CurveProblemTest, HasTheSolutionOfDenseLeastSquares) {
  // Simpson's rule is exact up to cubics: N″ of degree four has a product of degree four, and an
  // error of the fourth power of 1/64 in the fairness.
  for (const double smoothing : {0.0, 1e-6, 1e-2}) {
    ForRandomCurves(smoothing, [&](const FittingProblem& problem) {
      const Eigen::MatrixXd design = DesignMatrix(problem),
                            energy = EnergyMatrix(problem.basis_u());
      const Eigen::MatrixXd weighted = Weights(problem).asDiagonal() * design;
      const Eigen::MatrixXd normal = design.transpose() * weighted;
      const double lambda = smoothing * normal.trace() / energy.trace();
      const Eigen::MatrixXd expected =
          (normal + lambda * energy)
              .ldlt()
              .solve(weighted.transpose() * problem.data().values.transpose())
              .transpose();
      const LinearSolution solution = Solve(problem);
      EXPECT_FALSE(solution.regularised);
      EXPECT_LE(Difference(solution.coefficients, expected),
                smoothing > 0 ? kHalfDigits : kConditioned);
    });
  }
}

TEST(CurveProblemTest, RecoversTheCurveThatTheDataWereTakenFrom) {
  ForRandomCurves(0, [](const FittingProblem& given) {
    RandomSplines random(1);
    Eigen::MatrixXd net(given.data().values.rows(), given.unknowns());
    for (double& c : net.reshaped()) c = random.Real(-1, 1);
    auto data = std::make_shared<FittingData>(given.data());
    data->values = Evaluate(given, net);
    const FittingProblem problem(given.basis_u(), data, 0);
    const LinearSolution solution = Solve(problem);
    EXPECT_LE(Difference(solution.coefficients, net), kConditioned);
    EXPECT_LE(solution.residual_squares, kConditioned * Weights(problem).sum());
  });
}

TEST(CurveProblemTest, LeavesTheSquaresThatADirectSumFinds) {
  for (const double smoothing : {0.0, 1e-4, 1.0}) {
    ForRandomCurves(smoothing, [](const FittingProblem& problem) {
      const LinearSolution solution = Solve(problem);
      const double expected = DirectSquares(problem, solution.coefficients);
      EXPECT_NEAR(solution.residual_squares, expected, kIterated * expected);
    });
  }
}

TEST(CurveProblemTest, EvaluatesThePointsOfTheCurve) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<3> curve =
        random.Curve<3>(random.Integer(1, 5), false, {.clamped = random.Coin()});
    auto data = std::make_shared<FittingData>();
    data->parameters.setZero(2, 100);
    data->values = Eigen::MatrixXd::Zero(3, 100);
    for (double& u : data->parameters.row(0)) u = random.Parameter(curve.basis());
    const FittingProblem problem(curve.basis(), data, 0);
    const Eigen::MatrixXd values = Evaluate(problem, curve.control_points());
    for (Eigen::Index k = 0; k < 100; ++k) {
      EXPECT_LE(Difference(values.col(k), curve.At(data->parameters(0, k))), kRounding);
    }
  }
}

TEST(CurveProblemTest, GivesTheSameBitsForEveryNumberOfThreads) {
  ForRandomCurves(1e-4, [](const FittingProblem& problem) {
    EXPECT_EQ(Solve(problem, 3).coefficients, Solve(problem, 1).coefficients);
  });
}

TEST(CurveProblemTest, BridgesEmptySpans) {
  RandomSplines random(1);
  const SplineBasis basis = SplineBasis::Uniform(3, 14, 0, 1);
  auto data = std::make_shared<FittingData>();
  data->parameters.setZero(2, 100);
  data->values.resize(2, 100);
  for (Eigen::Index k = 0; k < 100; ++k) {
    const double u = k % 2 == 0 ? random.Real(0, 0.2) : random.Real(0.8, 1);
    data->parameters(0, k) = u;
    data->values.col(k) << u, 3 - 2 * u;
  }
  for (const double smoothing : {0.0, 1e-4}) {
    const LinearSolution solution = Solve(FittingProblem(basis, data, smoothing));
    EXPECT_EQ(solution.regularised, smoothing == 0);
    // A straight line costs nothing: it goes through the gap. The least smoothing that there must
    // be is 1e-12, beside which what keeps the matrix from rounding counts some percent.
    const double tolerance = smoothing > 0 ? kHalfDigits : 0.03;
    for (int i = 0; i < basis.size(); ++i) {
      EXPECT_NEAR(solution.coefficients(0, i), basis.Greville(i), tolerance);
      EXPECT_NEAR(solution.coefficients(1, i), 3 - 2 * basis.Greville(i), tolerance);
    }
  }
}

TEST(CurveProblemTest, HasOneBasisAndKeepsItsData) {
  const FittingProblem curve = RandomCurveProblem(1, 1e-3), surface = RandomProblem(1, 1e-3);
  EXPECT_TRUE(curve.is_curve());
  EXPECT_FALSE(surface.is_curve());
  EXPECT_EQ(curve.unknowns(), curve.basis_u().size());
  const SplineBasis other =
      SplineBasis::Uniform(5, 9, curve.basis_u().lower(), curve.basis_u().upper());
  const FittingProblem finer = curve.WithBasis(other);
  EXPECT_TRUE(finer.is_curve());
  EXPECT_EQ(&finer.data(), &curve.data());
  EXPECT_EQ(finer.basis_u(), other);
  EXPECT_EQ(finer.smoothing(), curve.smoothing());
  EXPECT_THAT(RefusalOf([&] { curve.WithBases(other, other); }), HasSubstr("curve"));
  EXPECT_THAT(RefusalOf([&] { surface.WithBasis(surface.basis_u()); }), HasSubstr("surface"));
  EXPECT_TRUE(curve.WithWeights(Eigen::VectorXd::Ones(curve.size())).is_curve());
}

TEST(CurveProblemTest, RefusesParametersOutsideTheDomain) {
  const SplineBasis basis = SplineBasis::Uniform(2, 4, 0, 1);
  RandomSplines random(9);
  for (const double bad : {std::nextafter(0.0, -1.0), std::nextafter(1.0, 2.0), std::nan("")}) {
    const auto data = RandomData(random, basis, basis, 10, 2);
    data->parameters(0, 4) = bad;
    EXPECT_NE(RefusalOf([&] { FittingProblem(basis, data, 0); }), "accepted") << bad;
  }
}

TEST(FittingProblemTest, TakesOtherParametersForTheSameData) {
  for (const FittingProblem& problem : {RandomProblem(2, 1e-3), RandomCurveProblem(2, 1e-3)}) {
    RandomSplines random(2);
    Eigen::Matrix2Xd parameters = problem.data().parameters;
    for (double& u : parameters.row(0))
      u = random.Real(problem.basis_u().lower(), problem.basis_u().upper());
    const FittingProblem moved = problem.WithParameters(parameters);
    EXPECT_EQ(moved.data().parameters, parameters);
    EXPECT_EQ(moved.data().values, problem.data().values);
    EXPECT_EQ(moved.data().weights, problem.data().weights);
    EXPECT_EQ(moved.basis_u(), problem.basis_u());
    EXPECT_EQ(moved.is_curve(), problem.is_curve());
    EXPECT_EQ(moved.smoothing(), problem.smoothing());
    EXPECT_NE(problem.data().parameters, parameters);
    const Eigen::Index fewer = parameters.cols() - 1;
    EXPECT_NE(RefusalOf([&] { problem.WithParameters(parameters.leftCols(fewer)); }), "accepted");
    parameters(0, 0) = problem.basis_u().upper() + 1;
    EXPECT_THAT(RefusalOf([&] { problem.WithParameters(parameters); }), HasSubstr("domain"));
  }
}

TEST(FittingProblemTest, KeepsItsEnergy) {
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Random(2, 40).cwiseAbs();
  data->values = Eigen::MatrixXd::Random(1, 40);
  const SplineBasis basis = SplineBasis::Uniform(3, 6, 0, 1),
                    finer = SplineBasis::Uniform(3, 7, 0, 1);
  EXPECT_EQ(FittingProblem(basis, basis, data, 1).energy(), FairnessEnergy::kThinPlate);
  const FittingProblem surface =
      FittingProblem(basis, basis, data, 1).WithEnergy(FairnessEnergy::kThirdOrder);
  const FittingProblem curve = FittingProblem(basis, data, 1).WithEnergy(FairnessEnergy::kMembrane);
  EXPECT_EQ(surface.WithBases(finer, basis).energy(), FairnessEnergy::kThirdOrder);
  EXPECT_EQ(curve.WithBasis(finer).energy(), FairnessEnergy::kMembrane);
  for (const FittingProblem& problem : {surface, curve}) {
    EXPECT_EQ(problem.WithSmoothing(2).energy(), problem.energy());
    EXPECT_EQ(problem.WithData(data).energy(), problem.energy());
    EXPECT_EQ(problem.WithWeights(Eigen::VectorXd::Ones(40)).energy(), problem.energy());
    EXPECT_EQ(problem.WithParameters(data->parameters).energy(), problem.energy());
  }
}

// With much smoothing what remains is what the energy does not see, fitted to the data: data of
// that kind are met exactly.
TEST(SolveLinearTest, MeetsWhatItsEnergyDoesNotSee) {
  ThreadPool pool(1);
  const SplineBasis basis = SplineBasis::Uniform(4, 9, 0, 1);
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Random(2, 400).cwiseAbs();
  for (int order = 1; order <= 3; ++order) {
    data->values.resize(1, 400);
    for (Eigen::Index k = 0; k < 400; ++k) {
      const double u = data->parameters(0, k), v = data->parameters(1, k);
      data->values(0, k) = 1 + (order > 1 ? u - 2 * v : 0) + (order > 2 ? u * v - 3 * v * v : 0);
    }
    for (int energy = 1; energy <= 3; ++energy) {
      const FittingProblem problem = FittingProblem(basis, basis, data, 1e4)
                                         .WithEnergy(energy == 1   ? FairnessEnergy::kMembrane
                                                     : energy == 2 ? FairnessEnergy::kThinPlate
                                                                   : FairnessEnergy::kThirdOrder);
      const double rms = std::sqrt(SolveLinear(problem, pool).residual_squares / 400);
      if (energy >= order) {
        EXPECT_LT(rms, kHalfDigits);
      } else {
        EXPECT_GT(rms, 0.05);
      }
    }
  }
}

}  // namespace batten::internal::fitting_problem_test
