// SPDX-License-Identifier: MIT
#include "fitting/knots/knot_line_removal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "fitting/knots/knot_grid_selection.h"
#include "fitting/least_squares/fitting_bases.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::knot_line_removal_test {

using Height = std::function<double(double, double)>;

// Flat on one half, wavy on the other.
double HalfWavy(double u, double v) {
  const double t = std::max(0.0, u - 0.5);
  return 3 * t * t * t * t * std::sin(25 * u) * std::cos(20 * v);
}

double WavyAll(double u, double v) { return 0.2 * std::sin(14 * u) * std::cos(14 * v); }

FittingProblem Measured(
    const Height& height, int count, double sigma, unsigned seed, double unit = 1) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, count);
  data->values.resize(1, count);
  for (int k = 0; k < count; ++k) {
    const double u = uniform(engine), v = uniform(engine);
    data->parameters.col(k) << unit * u, unit * v;
    data->values(0, k) = unit * (height(u, v) + sigma * normal(engine));
  }
  return FittingProblem(
      FittingBasis(3, 1, 0, unit), FittingBasis(3, 1, 0, unit), std::move(data), 1e-4);
}

FittingProblem OnGrid(const FittingProblem& problem, int cells_u, int cells_v) {
  return problem.WithBases(FittingBasis(3, cells_u, 0, problem.basis_u().upper()),
                           FittingBasis(3, cells_v, 0, problem.basis_v().upper()));
}

double TruthError(const FittingProblem& problem, const Height& truth) {
  constexpr int kAcross = 80;
  auto dense = std::make_shared<FittingData>();
  dense->parameters.resize(2, kAcross * kAcross);
  dense->values.resize(1, kAcross * kAcross);
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const double u = (i + 0.5) / kAcross, v = (j + 0.5) / kAcross;
      dense->parameters.col(i * kAcross + j) << u, v;
      dense->values(0, i * kAcross + j) = truth(u, v);
    }
  }
  ThreadPool pool(1);
  const Eigen::MatrixXd there =
      EvaluateAt(problem.WithData(dense), SolveLinear(problem, pool).coefficients, pool);
  return (there - dense->values).norm() / kAcross;
}

// Whether all knots of one basis are among those of another.
bool IsPartOf(const SplineBasis& some, const SplineBasis& all) {
  return std::includes(
      all.knots().begin(), all.knots().end(), some.knots().begin(), some.knots().end());
}

TEST(PruneKnotLinesTest, TakesLinesOutOfAFlatHalfWithoutHarm) {
  ThreadPool pool(1);
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const FittingProblem problem = OnGrid(Measured(HalfWavy, 6000, 2e-3, seed), 22, 16);
    const FittingProblem fewer = PruneKnotLines(problem, pool);
    EXPECT_TRUE(IsPartOf(fewer.basis_u(), problem.basis_u()));
    EXPECT_TRUE(IsPartOf(fewer.basis_v(), problem.basis_v()));
    EXPECT_LE(fewer.unknowns(), problem.unknowns() / 1.5);
    EXPECT_LE(TruthError(fewer, HalfWavy), 1.03 * TruthError(problem, HalfWavy));
    // What is left lies where the waves are.
    const std::vector<double>& knots = fewer.basis_u().knots();
    const auto flat =
        std::count_if(knots.begin(), knots.end(), [](double t) { return t > 0 && t < 0.4; });
    const auto wavy =
        std::count_if(knots.begin(), knots.end(), [](double t) { return t > 0.6 && t < 1; });
    EXPECT_LT(2 * flat, wavy);
  }
}

TEST(PruneKnotLinesTest, LeavesLinesThatAllPay) {
  ThreadPool pool(1);
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const FittingProblem problem = OnGrid(Measured(WavyAll, 20000, 1e-3, seed), 9, 9);
    EXPECT_EQ(PruneKnotLines(problem, pool).unknowns(), problem.unknowns());
  }
}

TEST(PruneKnotLinesTest, LeavesASingleCellOfAPlane) {
  ThreadPool pool(1);
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const FittingProblem problem =
        OnGrid(Measured([](double u, double v) { return u - 2 * v; }, 3000, 1e-2, seed), 9, 7);
    // By chance a line seems to pay once in a while.
    EXPECT_LE(PruneKnotLines(problem, pool).unknowns(), 24);
  }
}

TEST(PruneKnotLinesTest, DoesNotDependOnOrderUnitsOrThreads) {
  const FittingProblem problem = OnGrid(Measured(HalfWavy, 4000, 2e-3, 1), 18, 14);
  ThreadPool one(1), three(3);
  const FittingProblem fewer = PruneKnotLines(problem, one);
  EXPECT_EQ(PruneKnotLines(problem, three).basis_u().knots(), fewer.basis_u().knots());
  std::vector<Eigen::Index> order(4000);
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::shuffle(order.begin(), order.end(), std::mt19937_64(2));
  auto shuffled = std::make_shared<FittingData>();
  shuffled->parameters = problem.data().parameters(Eigen::all, order);
  shuffled->values = problem.data().values(Eigen::all, order);
  const FittingProblem other = PruneKnotLines(problem.WithData(std::move(shuffled)), one);
  EXPECT_EQ(other.basis_u().knots(), fewer.basis_u().knots());
  EXPECT_EQ(other.basis_v().knots(), fewer.basis_v().knots());
  // Powers of two change no rounding.
  for (const double unit : {std::ldexp(1.0, -20), std::ldexp(1.0, 20)}) {
    const FittingProblem scaled =
        PruneKnotLines(OnGrid(Measured(HalfWavy, 4000, 2e-3, 1, unit), 18, 14), one);
    EXPECT_EQ(scaled.basis_u().size(), fewer.basis_u().size());
    EXPECT_EQ(scaled.basis_v().size(), fewer.basis_v().size());
  }
}

TEST(PruneKnotLinesTest, TakesWeightsForCounts) {
  const FittingProblem problem = OnGrid(Measured(HalfWavy, 3000, 2e-3, 3), 18, 14);
  auto padded = std::make_shared<FittingData>(problem.data());
  // As many points again that weigh nothing.
  padded->parameters.conservativeResize(2, 6000);
  padded->parameters.rightCols(3000) = problem.data().parameters;
  padded->values.conservativeResize(1, 6000);
  padded->values.rightCols(3000).setConstant(1e3);
  padded->weights = Eigen::VectorXd::Ones(6000);
  padded->weights.tail(3000).setZero();
  ThreadPool pool(1);
  const FittingProblem fewer = PruneKnotLines(problem, pool),
                       other = PruneKnotLines(problem.WithData(std::move(padded)), pool);
  EXPECT_EQ(other.basis_u().knots(), fewer.basis_u().knots());
  EXPECT_EQ(other.basis_v().knots(), fewer.basis_v().knots());
}

TEST(PruneKnotLinesTest, WorksOnPointsInSpace) {
  const FittingProblem heights = OnGrid(Measured(HalfWavy, 6000, 2e-3, 4), 22, 16);
  auto data = std::make_shared<FittingData>();
  data->parameters = heights.data().parameters;
  data->values.resize(3, 6000);
  data->values.topRows(2) = heights.data().parameters;
  data->values.row(2) = heights.data().values;
  ThreadPool pool(1);
  const FittingProblem fewer = PruneKnotLines(heights.WithData(std::move(data)), pool),
                       flat = PruneKnotLines(heights, pool);
  EXPECT_EQ(fewer.basis_u().knots(), flat.basis_u().knots());
  EXPECT_EQ(fewer.basis_v().knots(), flat.basis_v().knots());
}

TEST(RefineAndPruneKnotLinesTest, FollowsALocalFeatureWithFewerControlPointsThanAnyGrid) {
  const Height bump = [](double u, double v) {
    return 0.2 * std::exp(-((u - 0.3) * (u - 0.3) + (v - 0.6) * (v - 0.6)) / (2 * 0.05 * 0.05));
  };
  ThreadPool pool(1);
  for (unsigned seed = 0; seed < 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const FittingProblem measured = Measured(bump, 8000, 1e-3, seed);
    const GridChoice choice = ChooseGrid(measured, {}, pool);
    const FittingProblem grid = OnGrid(measured, choice.cells_u, choice.cells_v);
    const FittingProblem found = RefineAndPruneKnotLines(grid, 20000, pool);
    EXPECT_LE(found.unknowns(), grid.unknowns() / 1.6);
    EXPECT_LE(TruthError(found, bump), 0.9 * TruthError(grid, bump));
  }
}

TEST(RefineAndPruneKnotLinesTest, KeepsToTheLimitOnControlPoints) {
  // Finer grids are tried only where they fit the limit: a limit that the next finer grid exceeds
  // leaves the lines of this grid, of which none is added.
  const Height bump = [](double u, double v) {
    return 0.2 * std::exp(-((u - 0.3) * (u - 0.3) + (v - 0.6) * (v - 0.6)) / (2 * 0.05 * 0.05));
  };
  ThreadPool pool(1);
  const FittingProblem grid = OnGrid(Measured(bump, 8000, 1e-3, 1), 12, 12);
  const auto is_of_the_grid = [](const SplineBasis& basis, const SplineBasis& of) {
    return std::includes(
        of.knots().begin(), of.knots().end(), basis.knots().begin(), basis.knots().end());
  };
  const FittingProblem free = RefineAndPruneKnotLines(grid, 20000, pool);
  ASSERT_FALSE(is_of_the_grid(free.basis_u(), grid.basis_u()) &&
               is_of_the_grid(free.basis_v(), grid.basis_v()))
      << "the limit would not matter";
  for (const int limit : {16, 200, grid.net_size()}) {
    SCOPED_TRACE("limit " + std::to_string(limit));
    const FittingProblem kept = RefineAndPruneKnotLines(grid, limit, pool);
    EXPECT_LE(kept.net_size(), std::max(limit, grid.net_size()));
    EXPECT_TRUE(is_of_the_grid(kept.basis_u(), grid.basis_u()));
    EXPECT_TRUE(is_of_the_grid(kept.basis_v(), grid.basis_v()));
  }
}

TEST(RemoveKnotLinesTest, KeepsATolerance) {
  // As many lines go as leave every residual within the tolerance.
  ThreadPool pool(1);
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const FittingProblem problem = OnGrid(Measured(HalfWavy, 6000, 0, seed), 40, 30);
    const auto worst = [&](const FittingProblem& p, const LinearSolution& solution) {
      return (EvaluateAt(p, solution.coefficients, pool) - p.data().values).cwiseAbs().maxCoeff();
    };
    const double tolerance = 3 * worst(problem, SolveLinear(problem, pool));
    const FittingProblem fewer = RemoveKnotLines(
        problem,
        [&](const FittingProblem& p, const LinearSolution& s) { return worst(p, s) <= tolerance; },
        pool);
    EXPECT_LE(worst(fewer, SolveLinear(fewer, pool)), tolerance);
    EXPECT_LE(fewer.unknowns(), 0.8 * problem.unknowns());
  }
}

TEST(RemoveKnotLinesTest, TakesAllLinesOrNoneAsItIsTold) {
  ThreadPool pool(1);
  const FittingProblem problem = OnGrid(Measured(WavyAll, 3000, 1e-3, 7), 11, 8);
  const FittingProblem none = RemoveKnotLines(
      problem, [](const auto&, const auto&) { return true; }, pool);
  EXPECT_EQ(none.unknowns(), 16);
  const FittingProblem all = RemoveKnotLines(
      problem, [](const auto&, const auto&) { return false; }, pool);
  EXPECT_EQ(all.basis_u().knots(), problem.basis_u().knots());
  EXPECT_EQ(all.basis_v().knots(), problem.basis_v().knots());
}

TEST(RemoveKnotLinesTest, LeavesPeriodicDirectionsAndMultipleKnotsAlone) {
  ThreadPool pool(1);
  const FittingProblem measured = Measured(WavyAll, 3000, 1e-3, 8);
  std::vector<double> knots;
  for (int i = -3; i <= 13; ++i) knots.push_back(i / 10.0);
  const SplineBasis around = SplineBasis::Periodic(3, knots);
  const SplineBasis doubled(3, {0, 0, 0, 0, 0.3, 0.5, 0.5, 0.8, 1, 1, 1, 1});
  const FittingProblem found = RemoveKnotLines(
      measured.WithBases(around, doubled), [](const auto&, const auto&) { return true; }, pool);
  EXPECT_EQ(found.basis_u().knots(), around.knots());
  EXPECT_EQ(found.basis_v().knots(), (std::vector<double>{0, 0, 0, 0, 0.5, 0.5, 1, 1, 1, 1}));
}

TEST(RemoveKnotLinesTest, RefusesCurves) {
  ThreadPool pool(1);
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, 20);
  data->parameters.row(0).setLinSpaced(0, 1);
  data->values = Eigen::MatrixXd::Zero(2, 20);
  const FittingProblem curve(FittingBasis(3, 2, 0, 1), std::move(data), 0);
  EXPECT_THROW(PruneKnotLines(curve, pool), std::invalid_argument);
  EXPECT_THROW(RefineAndPruneKnotLines(curve, 100, pool), std::invalid_argument);
  EXPECT_THROW(RemoveKnotLines(
                   curve, [](const auto&, const auto&) { return true; }, pool),
               std::invalid_argument);
}

}  // namespace batten::internal::knot_line_removal_test
