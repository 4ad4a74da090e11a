// SPDX-License-Identifier: MIT
#include "fitting/curve/parameter_correction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "fitting/curve/span_layout.h"
#include "geometry/numeric/constants.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::parameter_correction_test {

struct Case {
  FittingProblem problem;
  Eigen::MatrixXd coefficients;
  double noise;
};

// An arc, or all of a flower, in the plane or in space, a little uneven in its parameters; data in
// order along it, thrown off it by noise.
Case RandomCase(unsigned seed, int count, double noise, double unit = 1) {
  RandomSplines random(seed);
  const bool closed = random.Coin();
  const int degree = random.Integer(2, 5), spans = random.Integer(12, 20),
            dimension = random.Integer(2, 3);
  const SpanLayout layout = SpanLayout::Equal(degree, spans, 0, 1, {}, closed);
  const double turn = closed ? kTurn : 0.8 * kTurn;
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, count);
  data->values.resize(dimension, count);
  const double lift = random.Real(-0.3, 0.3);
  for (int k = 0; k < count; ++k) {
    const double u = closed ? (k + 0.5) / count : static_cast<double>(k) / (count - 1);
    const double t = turn * (u + 0.02 * std::sin(kTurn * u) * (closed ? 1 : u));
    data->parameters(0, k) = u;
    Eigen::Vector3d place((1 + 0.1 * std::cos(3 * t)) * std::cos(t),
                          (1 + 0.1 * std::cos(3 * t)) * std::sin(t),
                          lift * std::sin(t));
    for (int d = 0; d < dimension; ++d) {
      data->values(d, k) = unit * (place[d] + noise * random.Real(-1, 1));
    }
  }
  FittingProblem problem(layout.Basis(), std::move(data), 1e-10);
  ThreadPool pool(1);
  Eigen::MatrixXd coefficients = SolveLinear(problem, pool).coefficients;
  return {std::move(problem), std::move(coefficients), noise};
}

void ForCases(const std::function<void(const Case&)>& law, int count = 600) {
  for (unsigned seed = 0; seed < 24; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    law(RandomCase(seed, count, seed % 3 == 0 ? 0 : 0.01));
    if (testing::Test::HasFailure()) return;
  }
}

Eigen::VectorXd At(const FittingProblem& problem, const Eigen::MatrixXd& net, double u) {
  const SplineBasis& basis = problem.basis_u();
  const int span = basis.Span(u), p = basis.degree();
  Eigen::VectorXd values(p + 1);
  basis.Values(span, u, values.data());
  return net.middleCols(span - p, p + 1) * values;
}

double Distance(const Case& given, Eigen::Index k, double u) {
  return (given.problem.data().values.col(k) - At(given.problem, given.coefficients, u)).norm();
}

FittingProblem Moved(const Case& given) {
  ThreadPool pool(1);
  return CorrectedParameters(given.problem, given.coefficients, pool);
}

TEST(CurveAtTest, HasPointsOfTheCurveAndTangentsOfLengthOne) {
  ForCases([](const Case& given) {
    ThreadPool pool(1);
    const CurveSamples samples = CurveAt(given.problem, given.coefficients, pool);
    const double step = 1e-6;
    for (Eigen::Index k = 0; k < given.problem.size(); ++k) {
      const double u = given.problem.data().parameters(0, k);
      EXPECT_LE((samples.points.col(k) - At(given.problem, given.coefficients, u)).norm(),
                kRounding);
      EXPECT_NEAR(samples.tangents.col(k).norm(), 1, kRounding);
      const double low = std::max(0.0, u - step), high = std::min(1.0, u + step);
      const Eigen::VectorXd chord =
          At(given.problem, given.coefficients, high) - At(given.problem, given.coefficients, low);
      // One-sided at ends: wrong by half a step of the curvature, some tens here.
      EXPECT_LE((samples.tangents.col(k) - chord.normalized()).norm(), 1e-4);
    }
  });
}

TEST(CurveAtTest, HasNoTangentWhereTheCurveStandsStill) {
  const SplineBasis basis = SplineBasis::Uniform(3, 6, 0, 1);
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, 2);
  data->parameters(0, 1) = 0.5;
  data->values = Eigen::MatrixXd::Zero(2, 2);
  ThreadPool pool(1);
  const CurveSamples samples =
      CurveAt(FittingProblem(basis, data, 0), Eigen::MatrixXd::Ones(2, 6), pool);
  EXPECT_EQ(samples.tangents, Eigen::MatrixXd::Zero(2, 2));
}

TEST(AcrossTest, LeavesNothingAlongAndAllThatIsAcross) {
  RandomSplines random(1);
  for (const int dimension : {2, 3}) {
    Eigen::MatrixXd columns(dimension, 50), tangents(dimension, 50);
    for (double& x : columns.reshaped()) x = random.Real(-1, 1);
    for (double& x : tangents.reshaped()) x = random.Real(-1, 1);
    tangents.colwise().normalize();
    tangents.col(7).setZero();
    const Eigen::MatrixXd across = Across(columns, tangents);
    for (Eigen::Index k = 0; k < 50; ++k) {
      EXPECT_NEAR(across.col(k).dot(tangents.col(k)), 0, kRounding);
      const double along = columns.col(k).dot(tangents.col(k));
      EXPECT_NEAR(
          across.col(k).squaredNorm() + along * along, columns.col(k).squaredNorm(), kRounding);
    }
    EXPECT_EQ(across.col(7), columns.col(7));
  }
}

// The places are local minima: no parameter near by is nearer; where ends were left empty,
// parameters are those places stretched over the domain, in the same order.
TEST(CorrectedParametersTest, GivesLocalFootPoints) {
  ForCases(
      [](const Case& given) {
        const Eigen::RowVectorXd moved = Moved(given).data().parameters.row(0);
        const Eigen::RowVectorXd start = given.problem.data().parameters.row(0);
        const bool closed = given.problem.basis_u().periodic();
        // Dense search around the start, as far as a noisy point's foot can be; then the golden
        // section.
        Eigen::VectorXd feet(moved.size());
        for (Eigen::Index k = 0; k < moved.size(); ++k) {
          double best = start[k], least = Distance(given, k, best), step = 0.02;
          for (int fine = 0; fine < 30; ++fine, step /= 2) {
            const double middle = best;
            for (int side = -4; side <= 4; ++side) {
              double u = middle + side * step / 4;
              if (closed) u -= std::floor(u);
              u = std::clamp(u, 0.0, 1.0);
              const double distance = Distance(given, k, u);
              if (distance < least) {
                least = distance;
                best = u;
              }
            }
          }
          feet[k] = best;
        }
        const double first = closed ? 0 : feet.minCoeff(), last = closed ? 1 : feet.maxCoeff();
        for (Eigen::Index k = 0; k < moved.size(); ++k) {
          double difference = moved[k] - (feet[k] - first) / (last - first);
          if (closed) difference -= std::round(difference);
          // Places of minima are found to half the digits only, from values.
          EXPECT_NEAR(difference, 0, 10 * kHalfDigits) << k;
        }
      },
      200);
}

TEST(CorrectedParametersTest, BringsTheDataNearerTheCurveThatTheyAreMovedOn) {
  ForCases([](const Case& given) {
    if (!given.problem.basis_u().periodic()) return;  // there the domain is filled afterwards
    const FittingProblem moved = Moved(given);
    for (Eigen::Index k = 0; k < moved.size(); ++k) {
      EXPECT_LE(Distance(given, k, moved.data().parameters(0, k)),
                Distance(given, k, given.problem.data().parameters(0, k)) + kRounding);
    }
  });
}

TEST(CorrectedParametersTest, KeepsEverythingButTheParameters) {
  ForCases([](const Case& given) {
    const FittingProblem moved = Moved(given);
    EXPECT_EQ(moved.data().values, given.problem.data().values);
    EXPECT_EQ(moved.basis_u(), given.problem.basis_u());
    EXPECT_EQ(moved.smoothing(), given.problem.smoothing());
    EXPECT_GE(moved.data().parameters.row(0).minCoeff(), 0);
    EXPECT_LE(moved.data().parameters.row(0).maxCoeff(), 1);
    EXPECT_EQ(moved.data().parameters.row(1), given.problem.data().parameters.row(1));
  });
}

TEST(CorrectedParametersTest, GivesTheSameBitsForEveryNumberOfThreads) {
  const Case given = RandomCase(2, 3000, 0.01);
  ThreadPool one(1), three(3);
  EXPECT_EQ(CorrectedParameters(given.problem, given.coefficients, one).data().parameters,
            CorrectedParameters(given.problem, given.coefficients, three).data().parameters);
}

// A straight line from (0,0) to (1,0), parameters as lengths.
FittingProblem OnLine(const std::vector<double>& places, const std::vector<double>& weights = {}) {
  const SplineBasis basis = SplineBasis::Uniform(1, 2, 0, 1);
  auto data = std::make_shared<FittingData>();
  const auto count = static_cast<Eigen::Index>(places.size());
  data->parameters = Eigen::Matrix2Xd::Constant(2, count, 0.5);
  data->parameters.row(1).setZero();
  data->values = Eigen::MatrixXd::Zero(2, count);
  for (Eigen::Index k = 0; k < count; ++k) data->values(0, k) = places[static_cast<size_t>(k)];
  data->weights =
      Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(weights.size()));
  return FittingProblem(basis, std::move(data), 0);
}

std::vector<double> MovedOnLine(const FittingProblem& problem) {
  Eigen::MatrixXd net = Eigen::MatrixXd::Zero(2, 2);
  net(0, 1) = 1;
  ThreadPool pool(1);
  const Eigen::RowVectorXd u = CorrectedParameters(problem, net, pool).data().parameters.row(0);
  return {u.begin(), u.end()};
}

void ExpectPlaces(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], expected[k], kRounding) << k;
}

TEST(CorrectedParametersTest, FillsTheDomainOfAnOpenCurve) {
  ExpectPlaces(MovedOnLine(OnLine({0.1, 0.3, 0.5, 0.9})), {0, 0.25, 0.5, 1});
  ExpectPlaces(MovedOnLine(OnLine({-1, 0.3, 0.5, 2})), {0, 0.3, 0.5, 1});
  ExpectPlaces(MovedOnLine(OnLine({0.2, 0.3, 2})), {0, 0.125, 1});
}

TEST(CorrectedParametersTest, LeavesADomainThatIsNotHalfFilled) {
  ExpectPlaces(MovedOnLine(OnLine({0.3, 0.5, 0.7})), {0.3, 0.5, 0.7});
  ExpectPlaces(MovedOnLine(OnLine({0.4})), {0.4});
}

TEST(CorrectedParametersTest, FillsTheDomainByTheDataThatHaveWeight) {
  ExpectPlaces(MovedOnLine(OnLine({0.0, 0.2, 0.5, 0.8, 0.9}, {0, 1, 1, 1, 0})), {0, 0, 0.5, 1, 1});
}

TEST(FitWithCorrectionTest, SolvesOnlyWhenThereAreNoSteps) {
  ForCases([](const Case& given) {
    ThreadPool pool(1);
    const CorrectedFit fit = FitWithCorrection(given.problem, 0, pool);
    EXPECT_EQ(fit.steps, 0);
    EXPECT_EQ(fit.problem.data().parameters, given.problem.data().parameters);
    EXPECT_EQ(fit.solution.coefficients, given.coefficients);
  });
}

double SquaresAcross(const CorrectedFit& fit) {
  ThreadPool pool(1);
  const CurveSamples samples = CurveAt(fit.problem, fit.solution.coefficients, pool);
  return Across(fit.problem.data().values - samples.points, samples.tangents).squaredNorm();
}

TEST(FitWithCorrectionTest, TakesItsStepsAndComesNearerTheData) {
  ForCases([](const Case& given) {
    ThreadPool pool(1);
    const CorrectedFit none = FitWithCorrection(given.problem, 0, pool),
                       few = FitWithCorrection(given.problem, 3, pool);
    EXPECT_EQ(few.steps, 3);
    EXPECT_LE(few.solution.residual_squares, none.solution.residual_squares);
    if (given.noise == 0) {
      EXPECT_LE(SquaresAcross(few), SquaresAcross(none));
    }
    // What it returns is a solution of the problem it returns.
    EXPECT_EQ(SolveLinear(few.problem, pool).coefficients, few.solution.coefficients);
  });
}

// By means of twenty in a row, in which noise has no say.
TEST(FitWithCorrectionTest, KeepsTheOrderOfTheData) {
  ForCases([](const Case& given) {
    ThreadPool pool(1);
    const CorrectedFit fit = FitWithCorrection(given.problem, 5, pool);
    const bool closed = given.problem.basis_u().periodic();
    double before = 0;
    for (Eigen::Index b = 0; b < given.problem.size() / 20; ++b) {
      const Eigen::RowVectorXd u = fit.problem.data().parameters.row(0).segment(20 * b, 20);
      double mean = 0;
      for (const double at : u) mean += (closed ? at - u[0] - std::round(at - u[0]) : at - u[0]);
      mean = mean / 20 + u[0];
      double step = mean - before;
      if (closed) step -= std::round(step);
      if (b > 0) {
        EXPECT_GT(step, 0) << b;
      }
      before = mean;
    }
  });
}

TEST(FitWithCorrectionTest, TakesNoStepThatTurnsTheOrderRound) {
  // A zigzag that five coefficients can't follow: its feet on the nearly straight curve run to and
  // fro.
  const SplineBasis basis = SplineBasis::Uniform(3, 5, 0, 1);
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, 400);
  data->values.resize(2, 400);
  for (Eigen::Index k = 0; k < 400; ++k) {
    const double u = (static_cast<double>(k) + 0.5) / 400;
    data->parameters(0, k) = u;
    data->values.col(k) << u + 0.2 * std::sin(10 * kTurn * u), 0.1 * std::cos(10 * kTurn * u);
  }
  ThreadPool pool(1);
  const CorrectedFit fit = FitWithCorrection(FittingProblem(basis, data, 0), 3, pool);
  EXPECT_EQ(fit.steps, 0);
  EXPECT_EQ(fit.problem.data().parameters, data->parameters);
}

TEST(FitWithCorrectionTest, DoesNotKnowTheUnitOrTheOrigin) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    for (const double unit : {1e-6, 1e6}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", unit " + std::to_string(unit));
      const Case here = RandomCase(seed, 400, 0.01), there = RandomCase(seed, 400, 0.01, unit);
      auto data = std::make_shared<FittingData>(there.problem.data());
      data->values.array() += 1000 * unit;
      ThreadPool pool(1);
      const CorrectedFit a = FitWithCorrection(here.problem, 3, pool),
                         b = FitWithCorrection(there.problem.WithData(data), 3, pool);
      EXPECT_EQ(a.steps, b.steps);
      Eigen::ArrayXd moved =
          (a.problem.data().parameters - b.problem.data().parameters).row(0).array();
      if (here.problem.basis_u().periodic()) moved -= moved.round();
      EXPECT_LE(moved.abs().maxCoeff(), kHalfDigits);
      EXPECT_LE((b.solution.coefficients.array() / unit - 1000 - a.solution.coefficients.array())
                    .abs()
                    .maxCoeff(),
                kHalfDigits);
    }
  }
}

}  // namespace batten::internal::parameter_correction_test
