// SPDX-License-Identifier: MIT
#include "fitting/joint/smooth_parameters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "jittered_shell.h"
#include "random_splines.h"
#include "tolerances.h"

#include "batten/fitting/solve_linear.h"

namespace batten::internal::smooth_parameters_test {

ParameterScatter Scatter(const FittingProblem& problem) {
  ThreadPool pool(2);
  return ScatterOf(problem, SolveLinear(problem, pool).coefficients, pool);
}

TEST(ScatterOfTest, IsNotRoughWhereParametersAreSmooth) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    for (const double sigma : {1e-4, 1e-3, 1e-2}) {
      const ParameterScatter scatter = Scatter(
          JitteredShell({.points = 4000, .net = 14, .sigma = sigma, .jitter = 0, .seed = seed}));
      EXPECT_FALSE(scatter.rough()) << scatter.along << " along, " << scatter.across << " across";
      // Noise alike in all directions: one normal to the shell and two along it.
      EXPECT_NEAR(scatter.across, sigma, 0.2 * sigma + 2e-3);
    }
  }
}

TEST(ScatterOfTest, IsRoughWhereParametersAreJittered) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const ParameterScatter scatter = Scatter(
        JitteredShell({.points = 4000, .net = 14, .sigma = 1e-3, .jitter = 0.5, .seed = seed}));
    EXPECT_TRUE(scatter.rough()) << scatter.along << " along, " << scatter.across << " across";
  }
}

TEST(ScatterOfTest, TellsJitterFromSmoothnessOnCurvesToo) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    for (const double jitter : {0.0, 0.02}) {
      RandomSplines random(seed);
      auto data = std::make_shared<FittingData>();
      data->parameters.setZero(2, 1000);
      data->values.resize(2, 1000);
      for (Eigen::Index k = 0; k < 1000; ++k) {
        const double t = random.Real(0, 1);
        data->values.col(k) << std::cos(3 * t) + random.Real(-1e-3, 1e-3),
            std::sin(3 * t) + random.Real(-1e-3, 1e-3);
        data->parameters(0, k) = std::clamp(t + random.Real(-jitter, jitter), 0.0, 1.0);
      }
      const FittingProblem problem(SplineBasis::Uniform(3, 12, 0, 1), data, 0);
      EXPECT_EQ(Scatter(problem).rough(), jitter > 0);
    }
  }
}

TEST(WithSmoothParametersTest, MakesJitteredParametersSmooth) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const FittingProblem rough =
        JitteredShell({.points = 4500, .net = 14, .sigma = 1e-3, .jitter = 0.5, .seed = seed});
    ThreadPool pool(2);
    const FittingProblem smooth = WithSmoothParameters(rough, Loss::kNone, 1, pool).problem;
    EXPECT_EQ(smooth.basis_u(), rough.basis_u());
    EXPECT_EQ(smooth.basis_v(), rough.basis_v());
    EXPECT_EQ(smooth.data().values, rough.data().values);
    EXPECT_FALSE(Scatter(smooth).rough());
    EXPECT_LE(SolveLinear(smooth, pool).residual_squares,
              0.2 * SolveLinear(rough, pool).residual_squares);
  }
}

TEST(WithSmoothParametersTest, GivesTheSameForEveryNumberOfThreads) {
  const FittingProblem rough = JitteredShell({.points = 3000, .net = 12});
  ThreadPool one(1), more(2);
  const Eigen::Matrix2Xd a =
      WithSmoothParameters(rough, Loss::kNone, 1, one).problem.data().parameters;
  const Eigen::Matrix2Xd b =
      WithSmoothParameters(rough, Loss::kNone, 1, more).problem.data().parameters;
  EXPECT_LE((a - b).cwiseAbs().maxCoeff(), kIterated);
}

// Three spans or fewer have no coarser shape.
TEST(WithSmoothParametersTest, LeavesCoarseProblemsAlone) {
  const FittingProblem problem = JitteredShell({.points = 500, .net = 6});
  ThreadPool pool(1);
  EXPECT_EQ(WithSmoothParameters(problem, Loss::kNone, 1, pool).problem.data().parameters,
            problem.data().parameters);
}

TEST(WithSmoothParametersTest, StopsWhereItIsAskedTo) {
  const FittingProblem problem = JitteredShell({.points = 3000, .net = 24});
  ThreadPool pool(1);
  int calls = 0;
  const auto stop = [&](const char*, double) { return ++calls < 2; };
  const FittingProblem result = WithSmoothParameters(problem, Loss::kNone, 1, pool, stop).problem;
  EXPECT_EQ(calls, 2);
  EXPECT_TRUE(result.data().parameters.allFinite());
}

}  // namespace batten::internal::smooth_parameters_test
