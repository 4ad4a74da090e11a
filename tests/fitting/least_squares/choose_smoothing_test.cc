// SPDX-License-Identifier: MIT
// The weight of fairness from the data: by cross-validation and from the noise.
#include "fitting/least_squares/choose_smoothing.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/fit_curve.h"
#include "batten/fitting/solve_linear.h"
#include "tolerances.h"

namespace batten::internal::choose_smoothing_test {

// A wave with noise over more spans than it needs.
FittingProblem Wave(int count, int control_points, double sigma, unsigned seed, double unit = 1) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0, sigma);
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, count);
  data->values.resize(2, count);
  for (int k = 0; k < count; ++k) {
    const double u = k / (count - 1.0);
    data->parameters(0, k) = u;
    data->values.col(k) << unit * (u + noise(engine)), unit * (std::sin(9 * u) + noise(engine));
  }
  return FittingProblem(SplineBasis::Uniform(3, control_points, 0, 1), std::move(data), 1e-6);
}

double OffTheWave(const FittingProblem& problem, ThreadPool& pool) {
  const Eigen::MatrixXd at = EvaluateAt(problem, SolveLinear(problem, pool).coefficients, pool);
  double squares = 0;
  for (Eigen::Index k = 0; k < at.cols(); ++k) {
    const double u = problem.data().parameters(0, k);
    squares += (at.col(k) - Eigen::Vector2d(u, std::sin(9 * u))).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(at.cols()));
}

// The trace of the matrix that takes data to fitted values, one unit datum after the other.
double TraceByColumns(const FittingProblem& problem, ThreadPool& pool) {
  double trace = 0;
  for (Eigen::Index k = 0; k < problem.size(); ++k) {
    auto data = std::make_shared<FittingData>(problem.data());
    data->values = Eigen::MatrixXd::Zero(1, problem.size());
    data->values(0, k) = 1;
    const FittingProblem unit = problem.WithData(std::move(data));
    trace += EvaluateAt(unit, SolveLinear(unit, pool).coefficients, pool)(0, k);
  }
  return trace;
}

TEST(EffectiveFreedomTest, IsTheTraceOfTheSmoother) {
  ThreadPool pool(1);
  const FittingProblem problem = Wave(120, 30, 0.1, 1);
  for (const double smoothing : {1e-9, 1e-5, 1e-2, 10.0}) {
    SCOPED_TRACE(smoothing);
    const FittingProblem smooth = problem.WithSmoothing(smoothing);
    EXPECT_NEAR(EffectiveFreedom(smooth, pool), TraceByColumns(smooth, pool), kHalfDigits * 30);
  }
}

TEST(EffectiveFreedomTest, FallsFromAllControlPointsToStraightLines) {
  ThreadPool pool(1);
  const FittingProblem problem = Wave(400, 40, 0.1, 2);
  double before = 40 + kHalfDigits;
  for (const double smoothing : {1e-12, 1e-8, 1e-4, 1.0, 1e4, 1e8}) {
    const double freedom = EffectiveFreedom(problem.WithSmoothing(smoothing), pool);
    EXPECT_LT(freedom, before);
    before = freedom;
  }
  EXPECT_NEAR(before, 2, 0.1);
}

// 64 probes of ±1 are right to a few hundredths of what they estimate.
TEST(EffectiveFreedomTest, IsEstimatedWhereThereAreManyControlPoints) {
  ThreadPool pool(1);
  const FittingProblem problem = Wave(3000, 300, 0.1, 3).WithSmoothing(1e-4);
  EXPECT_NEAR(EffectiveFreedom(problem, pool), TraceByColumns(problem, pool), 2);
}

TEST(SmoothingByCrossValidationTest, ComesNearTheBestThatTheTruthWouldChoose) {
  ThreadPool pool(1);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const FittingProblem problem = Wave(300, 80, 0.1, seed);
    double best = 1e9;
    for (double power = -12; power <= 3; power += 0.5) {
      best = std::min(best, OffTheWave(problem.WithSmoothing(std::pow(10, power)), pool));
    }
    const double smoothing = SmoothingByCrossValidation(problem, pool);
    EXPECT_LT(OffTheWave(problem.WithSmoothing(smoothing), pool), 1.3 * best);
    EXPECT_GT(OffTheWave(problem.WithSmoothing(1e-12), pool), 1.5 * best);  // it matters
  }
}

TEST(SmoothingByCrossValidationTest, IsTheSameInEveryUnit) {
  ThreadPool pool(1);
  const double smoothing = SmoothingByCrossValidation(Wave(200, 40, 0.05, 4), pool);
  for (const double unit : {1e-6, 1e6}) {
    EXPECT_EQ(SmoothingByCrossValidation(Wave(200, 40, 0.05, 4, unit), pool), smoothing);
  }
}

TEST(SmoothingFromNoiseTest, LeavesAsMuchAsTheNoise) {
  ThreadPool pool(1);
  const double noise = 0.12;  // somewhat above what chance may make of 0.1
  const FittingProblem problem = Wave(500, 60, 0.1, 5);
  const double smoothing = SmoothingFromNoise(problem, noise, pool);
  const auto left = [&](double factor) {
    const FittingProblem smooth = problem.WithSmoothing(smoothing * factor);
    return SolveLinear(smooth, pool).residual_squares /
           (2 * noise * noise * (500 - EffectiveFreedom(smooth, pool)));
  };
  EXPECT_LE(left(1), 1);
  EXPECT_GT(left(1.3), 1);  // the largest that does, to a tenth of a power of ten
  EXPECT_THROW(SmoothingFromNoise(problem, 0, pool), std::invalid_argument);
}

// A bump over far more control points than it needs, over random places.
FittingProblem Bump(int count, int size_u, int size_v, double sigma, unsigned seed, int rows = 1) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0, sigma);
  std::uniform_real_distribution<double> uniform(0, 1);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, count);
  data->values.resize(rows, count);
  for (int k = 0; k < count; ++k) {
    const double u = uniform(engine), v = uniform(engine);
    data->parameters.col(k) << u, v;
    const Eigen::Vector3d at(std::exp(-9 * (u * u + v * v)) + std::sin(4 * v), u, v);
    for (int d = 0; d < rows; ++d) data->values(d, k) = at[d] + noise(engine);
  }
  return FittingProblem(SplineBasis::Uniform(3, size_u, 0, 1),
                        SplineBasis::Uniform(3, size_v, 0, 1),
                        std::move(data),
                        1e-6);
}

double OffTheBump(const FittingProblem& problem, ThreadPool& pool) {
  const Eigen::MatrixXd at = EvaluateAt(problem, SolveLinear(problem, pool).coefficients, pool);
  double squares = 0;
  for (Eigen::Index k = 0; k < at.cols(); ++k) {
    const double u = problem.data().parameters(0, k), v = problem.data().parameters(1, k);
    squares += std::pow(at(0, k) - std::exp(-9 * (u * u + v * v)) - std::sin(4 * v), 2);
  }
  return std::sqrt(squares / static_cast<double>(at.cols()));
}

TEST(EffectiveFreedomTest, OfASurfaceIsTheTraceOfTheSmoother) {
  ThreadPool pool(1);
  for (const auto& [nu, nv] : {std::pair{9, 7}, {6, 12}}) {
    const FittingProblem problem = Bump(150, nu, nv, 0.1, 7);
    for (const double smoothing : {1e-6, 1e-3, 1.0}) {
      const FittingProblem smooth = problem.WithSmoothing(smoothing);
      EXPECT_NEAR(EffectiveFreedom(smooth, pool), TraceByColumns(smooth, pool), kHalfDigits * 80);
    }
  }
}

TEST(EffectiveFreedomTest, CountsWhatPolesTieTogetherOnce) {
  ThreadPool pool(2);
  std::mt19937_64 engine(11);
  std::uniform_real_distribution<double> unit(0, 1);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, 300);
  for (double& x : data->parameters.reshaped()) x = unit(engine);
  data->values = Eigen::MatrixXd::Zero(1, 300);
  const FittingProblem problem =
      FittingProblem(
          SplineBasis::Uniform(3, 8, 0, 1), SplineBasis::Uniform(3, 7, 0, 1), std::move(data), 1e-6)
          .WithPoles({PoleKind::kSmooth, PoleKind::kApex});
  for (const double smoothing : {1e-8, 1e-4}) {
    SCOPED_TRACE(smoothing);
    const FittingProblem smooth = problem.WithSmoothing(smoothing);
    EXPECT_NEAR(EffectiveFreedom(smooth, pool), TraceByColumns(smooth, pool), kHalfDigits * 56);
    EXPECT_LE(EffectiveFreedom(smooth, pool), problem.unknowns() + kHalfDigits);
  }
}

TEST(EffectiveFreedomTest, FallsToWhatTheEnergyDoesNotSee) {
  ThreadPool pool(1);
  const FittingProblem problem = Bump(600, 10, 12, 0.1, 8).WithSmoothing(1e9);
  // Constants; planes; quadratics in u and v. What rounding adds to 1e9 of a singular matrix takes
  // a little of them.
  EXPECT_NEAR(EffectiveFreedom(problem.WithEnergy(FairnessEnergy::kMembrane), pool), 1, 0.1);
  EXPECT_NEAR(EffectiveFreedom(problem.WithEnergy(FairnessEnergy::kThinPlate), pool), 3, 0.1);
  EXPECT_NEAR(EffectiveFreedom(problem.WithEnergy(FairnessEnergy::kThirdOrder), pool), 6, 0.1);
}

TEST(SmoothingByCrossValidationTest, OfASurfaceComesNearTheBestThatTheTruthWouldChoose) {
  ThreadPool pool(1);
  for (const FairnessEnergy energy : {FairnessEnergy::kThinPlate, FairnessEnergy::kThirdOrder}) {
    for (unsigned seed = 1; seed <= 2; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      const FittingProblem problem = Bump(1500, 22, 18, 0.1, seed).WithEnergy(energy);
      double best = 1e9;
      for (double power = -9; power <= 4; power += 0.5)
        best = std::min(best, OffTheBump(problem.WithSmoothing(std::pow(10, power)), pool));
      const double smoothing = SmoothingByCrossValidation(problem, pool);
      EXPECT_LT(OffTheBump(problem.WithSmoothing(smoothing), pool), 1.2 * best);
      EXPECT_GT(OffTheBump(problem.WithSmoothing(1e-12), pool), 1.5 * best);  // it matters
    }
  }
}

TEST(SmoothingByCrossValidationTest, IsTheSameOnEveryNumberOfThreads) {
  ThreadPool one(1), three(3);
  const FittingProblem problem = Bump(1500, 22, 18, 0.1, 3);
  EXPECT_EQ(SmoothingByCrossValidation(problem, three), SmoothingByCrossValidation(problem, one));
  EXPECT_EQ(EffectiveFreedom(problem, three), EffectiveFreedom(problem, one));
}

TEST(FitCurveSmoothingTest, KeepsManySpansCalm) {
  const FittingProblem wave = Wave(400, 4, 0.03, 6);
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 400);
  points.topRows<2>() = wave.data().values;
  const PointCloud cloud(points, Eigen::Vector3d::Zero(), 2);
  const auto off = [&](const CurveFitOptions& options) {
    const NurbsCurve<2> curve = FitCurve<2>(cloud, options).curve;
    double squares = 0;
    for (int k = 0; k <= 500; ++k) {
      const Eigen::Vector2d at = curve.At(k / 500.0);
      const double slope = 9 * std::cos(9 * at[0]);
      squares += std::pow((at[1] - std::sin(9 * at[0])) / std::hypot(1, slope), 2);
    }
    return std::sqrt(squares / 501);
  };
  CurveFitOptions free;
  free.control_points = 120;
  free.optimize = FreeVariables{};
  for (const SmoothBy by : {SmoothBy::kCrossValidation, SmoothBy::kNoise}) {
    CurveFitOptions options = free;
    options.smooth_by = by;
    EXPECT_EQ(FitCurve<2>(cloud, options).curve.basis().size(), 120);
    EXPECT_LT(off(options), 0.6 * off(free));
    options.tolerance = 0.1;
    EXPECT_THROW(FitCurve<2>(cloud, options), std::invalid_argument);
    options.tolerance.reset();
    options.loss = Loss::kHuber;
    EXPECT_THROW(FitCurve<2>(cloud, options), std::invalid_argument);
  }
}

}  // namespace batten::internal::choose_smoothing_test
