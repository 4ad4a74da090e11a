// SPDX-License-Identifier: MIT
#include "batten/fitting/voids.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "tolerances.h"

namespace batten {
namespace {

constexpr int kPoints = 5000;
constexpr double kSpacing = 1.0 / 70;  // of so many on the unit square

using Where = std::function<bool(double, double)>;
using Height = std::function<double(double, double)>;

bool OutsideAHole(double u, double v) { return std::hypot(u - 0.55, v - 0.5) > 0.35; }
bool InAnL(double u, double v) { return u < 0.35 || v < 0.3; }
bool Anywhere(double, double) { return true; }

// Falls steeply towards the hole and the corner of the L: what a free spline shoots on from.
double Wild(double u, double v) { return 3 * std::sin(9 * u + 1) * std::cos(7 * v) + 4 * u * v; }
// Falls off ever more steeply to the rim of the hole, from all sides.
double Funnel(double u, double v) {
  return -std::exp(-(std::hypot(u - 0.55, v - 0.5) - 0.35) / 0.05);
}

FittingProblem Measured(
    const Height& height, const Where& where, unsigned seed, int size, double sigma = 0.01) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, kPoints);
  data->values.resize(1, kPoints);
  for (int k = 0; k < kPoints;) {
    const double u = uniform(engine), v = uniform(engine);
    if (!where(u, v)) continue;
    data->parameters.col(k) << u, v;
    data->values(0, k++) = height(u, v) + sigma * normal(engine);
  }
  const SplineBasis basis = SplineBasis::Uniform(3, size, 0, 1);
  return FittingProblem(basis, basis, std::move(data), 1e-4);
}

CalmResult Calm(const FittingProblem& problem, int threads = 1) {
  ThreadPool pool(threads);
  return SolveCalmly(problem, {.spacing = kSpacing, .measured = kPoints}, pool);
}

// Least and greatest value on a grid much finer than the cells.
std::pair<double, double> RangeOf(const FittingProblem& problem,
                                  const Eigen::MatrixXd& coefficients) {
  constexpr int kAcross = 401;
  auto dense = std::make_shared<FittingData>();
  dense->parameters.resize(2, kAcross * kAcross);
  dense->values = Eigen::MatrixXd::Zero(1, kAcross * kAcross);
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      dense->parameters.col(i * kAcross + j) << i / (kAcross - 1.0), j / (kAcross - 1.0);
    }
  }
  ThreadPool pool(1);
  const Eigen::MatrixXd values = EvaluateAt(
      FittingProblem(problem.basis_u(), problem.basis_v(), dense, 0), coefficients, pool);
  return {values.minCoeff(), values.maxCoeff()};
}

// A fiftieth of the range is granted at samples, three a cell and direction; between them a cubic
// bends out a little farther. Where a void meets the border of the domain, the slope of the data is
// granted there besides: up to a tenth of the range in the steepest of these shapes.
constexpr double kInside = 0.03, kAtBorder = 0.15;

void ExpectWithinRange(const FittingProblem& problem, const CalmResult& result, double margin) {
  const double low = problem.data().values.minCoeff(), high = problem.data().values.maxCoeff();
  const auto [least, greatest] = RangeOf(problem, result.solution.coefficients);
  EXPECT_GE(least, low - margin * (high - low));
  EXPECT_LE(greatest, high + margin * (high - low));
}

TEST(SolveCalmlyTest, KeepsTheRangeOfTheDataOverHolesAndMissingCorners) {
  for (const int size : {8, 15, 30}) {
    for (const auto& [name, where] :
         {std::pair<const char*, Where>{"hole", OutsideAHole}, {"L", InAnL}}) {
      for (const auto& [shape, height] :
           {std::pair<const char*, Height>{"wild", Wild}, {"funnel", Funnel}}) {
        SCOPED_TRACE(std::string(shape) + " with " + name + ", " + std::to_string(size) +
                     " squared");
        const FittingProblem problem = Measured(height, where, 1, size);
        ExpectWithinRange(
            problem, Calm(problem), std::string(name) == "hole" ? kInside : kAtBorder);
      }
    }
  }
}

TEST(SolveCalmlyTest, HoldsWhatAFreeSolutionDoesNot) {
  ThreadPool pool(1);
  const FittingProblem problem = Measured(Funnel, OutsideAHole, 2, 20);
  const auto [least, greatest] = RangeOf(problem, SolveLinear(problem, pool).coefficients);
  const double low = problem.data().values.minCoeff(), high = problem.data().values.maxCoeff();
  ASSERT_TRUE(least < low - 0.1 * (high - low) || greatest > high + 0.1 * (high - low))
      << "the case is meant to shoot out of its range";
  const CalmResult result = Calm(problem);
  EXPECT_GT(result.places_held, 0);
  EXPECT_GT(result.problem.size(), problem.size());
  ExpectWithinRange(problem, result, kInside);
}

TEST(SolveCalmlyTest, LetsATiltedPlaneGoOnWhereThereAreNoPoints) {
  const FittingProblem problem =
      Measured([](double u, double v) { return 5 * u + 3 * v; }, InAnL, 6, 9, 0);
  const CalmResult result = Calm(problem);
  EXPECT_EQ(result.places_held, 0);
  EXPECT_NEAR(RangeOf(problem, result.solution.coefficients).second,
              8,
              1e-5);  // extrapolated over most of the square, rounding grows
}

TEST(SolveCalmlyTest, HardlyTouchesWhereThereAreData) {
  ThreadPool pool(1);
  const FittingProblem problem = Measured(Wild, OutsideAHole, 3, 20);
  const Eigen::MatrixXd calm = EvaluateAt(problem, Calm(problem).solution.coefficients, pool);
  // Noise of 0.01; what the holds add to it near the rim must stay of that order.
  EXPECT_LE((calm - problem.data().values).norm() / std::sqrt(kPoints), 3 * 0.01);
}

TEST(SolveCalmlyTest, ChangesNotABitWhereTheSurfaceKeepsTheRangeByItself) {
  ThreadPool pool(1);
  for (const int size : {6, 15, 25}) {
    SCOPED_TRACE(std::to_string(size) + " squared");
    for (const Where& where : {Where(Anywhere), Where(OutsideAHole)}) {
      // Hardly any noise, lest a corner be thrown off by it.
      const FittingProblem problem =
          Measured([](double u, double v) { return 2 * u - v; }, where, 4, size, 0.0001);
      const CalmResult result = Calm(problem);
      EXPECT_EQ(result.solution.coefficients, SolveLinear(problem, pool).coefficients);
      EXPECT_EQ(result.places_held, 0);
      EXPECT_EQ(&result.problem.data(), &problem.data());
    }
  }
}

TEST(SolveCalmlyTest, SolvesTheProblemItReturns) {
  ThreadPool pool(1);
  const CalmResult result = Calm(Measured(Wild, InAnL, 5, 20));
  EXPECT_EQ(result.solution.coefficients, SolveLinear(result.problem, pool).coefficients);
}

TEST(SolveCalmlyTest, KeepsTheMeasuredDataFirst) {
  const FittingProblem problem = Measured(Wild, InAnL, 5, 20);
  const CalmResult result = Calm(problem);
  ASSERT_GE(result.problem.size(), kPoints);
  EXPECT_EQ(result.problem.data().parameters.leftCols(kPoints), problem.data().parameters);
  EXPECT_EQ(result.problem.data().values.leftCols(kPoints), problem.data().values);
}

TEST(SolveCalmlyTest, SaysHowMuchOfTheDomainIsEmpty) {
  // The places counted are three spacings wide, so those on the rim are partly empty: within 0.06.
  EXPECT_NEAR(Calm(Measured(Funnel, Anywhere, 6, 8)).empty_share, 0, 0.01);
  EXPECT_NEAR(Calm(Measured(Funnel, OutsideAHole, 6, 8)).empty_share, 3.1416 * 0.35 * 0.35, 0.06);
  EXPECT_NEAR(Calm(Measured(Funnel, InAnL, 6, 8)).empty_share, 0.65 * 0.7, 0.06);
}

TEST(SolveCalmlyTest, ScalesWithTheHeights) {
  const FittingProblem problem = Measured(Wild, OutsideAHole, 7, 15);
  auto data = std::make_shared<FittingData>(problem.data());
  data->values *= 1024;
  const CalmResult one = Calm(problem);
  const CalmResult other =
      Calm(FittingProblem(problem.basis_u(), problem.basis_v(), data, problem.smoothing()));
  EXPECT_EQ(other.places_held, one.places_held);
  EXPECT_LE((other.solution.coefficients - 1024 * one.solution.coefficients).cwiseAbs().maxCoeff(),
            kIterated * 1024);
}

TEST(SolveCalmlyTest, GivesTheSameBitsForEveryNumberOfThreads) {
  const FittingProblem problem = Measured(Wild, OutsideAHole, 8, 15);
  const CalmResult one = Calm(problem, 1);
  for (const int threads : {2, 3}) {
    EXPECT_EQ(Calm(problem, threads).solution.coefficients, one.solution.coefficients);
  }
}

TEST(SolveCalmlyTest, KeepsLevelDataLevel) {
  const FittingProblem problem = Measured([](double, double) { return 7; }, OutsideAHole, 9, 15, 0);
  const auto [least, greatest] = RangeOf(problem, Calm(problem).solution.coefficients);
  EXPECT_NEAR(least, 7, kHalfDigits);
  EXPECT_NEAR(greatest, 7, kHalfDigits);
}

}  // namespace
}  // namespace batten
