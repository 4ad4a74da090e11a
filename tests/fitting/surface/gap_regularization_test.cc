// SPDX-License-Identifier: MIT
#include "fitting/surface/gap_regularization.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "known_clouds.h"
#include "tolerances.h"

namespace batten::internal::gap_regularization_test {

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

GapRegularizationResult Regularized(const FittingProblem& problem, int threads = 1) {
  ThreadPool pool(threads);
  return SolveWithGapRegularization(problem, {.spacing = kSpacing, .measured = kPoints}, pool);
}

// Least and greatest value on a grid much finer than the cells, of what lies in the void.
std::pair<double, double> RangeOf(const FittingProblem& problem,
                                  const Eigen::MatrixXd& coefficients,
                                  const Where& counts = Anywhere) {
  constexpr int kAcross = 401;
  auto dense = std::make_shared<FittingData>();
  dense->parameters.resize(2, kAcross * kAcross);
  Eigen::Index count = 0;
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const double u = i / (kAcross - 1.0), v = j / (kAcross - 1.0);
      if (counts(u, v)) dense->parameters.col(count++) << u, v;
    }
  }
  dense->parameters.conservativeResize(2, count);
  dense->values = Eigen::MatrixXd::Zero(1, count);
  ThreadPool pool(1);
  const Eigen::MatrixXd values = EvaluateAt(problem.WithData(dense), coefficients, pool);
  return {values.minCoeff(), values.maxCoeff()};
}

// The header grants 8 % of the rim's range, which is not above that of all data, and, where a void
// meets the border, what the slope makes of the way, up to a tenth of all data's range besides what
// the rim has. Besides, data stop within a spacing of a void's edge: the funnel falls by 20 there
// for every unit, 0.29 in a spacing.
void ExpectWithinRange(const FittingProblem& problem,
                       const GapRegularizationResult& result,
                       const Where& where,
                       double at_border,
                       double last_spacing) {
  const double low = problem.data().values.minCoeff(), high = problem.data().values.maxCoeff();
  const auto [least, greatest] = RangeOf(result.problem,
                                         result.solution.coefficients,
                                         [&](double u, double v) { return !where(u, v); });
  const double margin = (0.1 + at_border) * (high - low) + last_spacing;
  EXPECT_GE(least, low - margin);
  EXPECT_LE(greatest, high + margin);
}

TEST(SolveWithGapRegularizationTest, KeepsTheRangeOfTheDataOverHolesAndMissingCorners) {
  for (const int size : {8, 15, 30}) {
    for (const auto& [name, where] :
         {std::pair<const char*, Where>{"hole", OutsideAHole}, {"L", InAnL}}) {
      for (const auto& [shape, height, last] :
           {std::tuple<const char*, Height, double>{"wild", Wild, 0}, {"funnel", Funnel, 0.29}}) {
        SCOPED_TRACE(std::string(shape) + " with " + name + ", " + std::to_string(size) +
                     " squared");
        const FittingProblem problem = Measured(height, where, 1, size);
        ExpectWithinRange(
            problem, Regularized(problem), where, std::string(name) == "L" ? 0.05 : 0, last);
      }
    }
  }
}

TEST(SolveWithGapRegularizationTest, HoldsWhatAFreeSolutionDoesNot) {
  ThreadPool pool(1);
  const FittingProblem problem = Measured(Funnel, OutsideAHole, 2, 20);
  const double least = RangeOf(problem, SolveLinear(problem, pool).coefficients).first;
  ASSERT_LT(least, -5) << "the case is meant to shoot out of its range";
  const GapRegularizationResult result = Regularized(problem);
  EXPECT_EQ(result.gaps_held, 1);
  EXPECT_GT(result.places_held, 0);
  ExpectWithinRange(problem, result, OutsideAHole, 0, 0.29);
}

TEST(SolveWithGapRegularizationTest, LetsATiltedPlaneGoOnWhereThereAreNoPoints) {
  const FittingProblem problem =
      Measured([](double u, double v) { return 5 * u + 3 * v; }, InAnL, 6, 9, 0);
  const GapRegularizationResult result = Regularized(problem);
  EXPECT_EQ(result.places_held, 0);
  EXPECT_NEAR(RangeOf(problem, result.solution.coefficients).second,
              8,
              1e-5);  // extrapolated over most of the square, rounding grows
}

// A peak over the hole: the range of its rim asks for a plateau.
double Peak(double u, double v) {
  return std::exp(-8 * std::pow(std::hypot(u - 0.5, v - 0.45), 2));
}

TEST(SolveWithGapRegularizationTest, HardlyTouchesWhereThereAreData) {
  ThreadPool pool(1);
  const FittingProblem problem = Measured(Peak, OutsideAHole, 3, 12);
  const GapRegularizationResult calm = Regularized(problem);
  ASSERT_EQ(calm.gaps_held, 1);
  const LinearSolution free = SolveLinear(problem, pool);
  const Eigen::MatrixXd moved = EvaluateAt(calm.problem, calm.solution.coefficients, pool) -
                                EvaluateAt(problem, free.coefficients, pool);
  // Noise makes an error of σ² for every control point.
  const double by_noise = free.residual_squares / kPoints * problem.unknowns();
  EXPECT_LE(moved.squaredNorm(), 0.04 * by_noise);
  const double squares =
      (EvaluateAt(calm.problem, calm.solution.coefficients, pool) - problem.data().values)
          .squaredNorm();
  EXPECT_NEAR(calm.solution.residual_squares, squares, kRounding * squares);
  EXPECT_EQ(calm.solution.coefficients.cols(), calm.problem.net_size());
  EXPECT_EQ(&calm.problem.data(), &problem.data());
}

TEST(SolveWithGapRegularizationTest, KeepsTheRangeOfTheRim) {
  const FittingProblem problem = Measured(Peak, OutsideAHole, 3, 12, 1e-3);
  const GapRegularizationResult calm = Regularized(problem);
  double low = 1, high = 0;
  for (int k = 0; k < 1000; ++k) {
    const double angle = 2 * std::numbers::pi * k / 1000;
    const double z = Peak(0.55 + 0.35 * std::cos(angle), 0.5 + 0.35 * std::sin(angle));
    low = std::min(low, z);
    high = std::max(high, z);
  }
  const auto [least, greatest] = RangeOf(calm.problem,
                                         calm.solution.coefficients,
                                         [](double u, double v) { return !OutsideAHole(u, v); });
  // 8 % and the rise over the last spacing, which the rim's places do not see.
  EXPECT_LE(greatest, high + 0.1 * (high - low));
  EXPECT_GE(least, low - 0.1 * (high - low));
}

TEST(SolveWithGapRegularizationTest, ChangesNotABitWhereTheSurfaceKeepsTheRangeByItself) {
  ThreadPool pool(1);
  for (const int size : {6, 15, 25}) {
    SCOPED_TRACE(std::to_string(size) + " squared");
    for (const Where& where : {Where(Anywhere), Where(OutsideAHole)}) {
      // Hardly any noise, lest a corner be thrown off by it.
      const FittingProblem problem =
          Measured([](double u, double v) { return 2 * u - v; }, where, 4, size, 0.0001);
      const GapRegularizationResult result = Regularized(problem);
      EXPECT_EQ(result.solution.coefficients, SolveLinear(problem, pool).coefficients);
      EXPECT_EQ(result.places_held, 0);
      EXPECT_EQ(&result.problem.data(), &problem.data());
    }
  }
}

TEST(SolveWithGapRegularizationTest, SaysHowMuchOfTheDomainIsEmpty) {
  // The places counted are three spacings wide, so those on the rim are partly empty: within 0.06.
  EXPECT_NEAR(Regularized(Measured(Funnel, Anywhere, 6, 8)).empty_area_fraction, 0, 0.01);
  EXPECT_NEAR(Regularized(Measured(Funnel, OutsideAHole, 6, 8)).empty_area_fraction,
              3.1416 * 0.35 * 0.35,
              0.06);
  EXPECT_NEAR(Regularized(Measured(Funnel, InAnL, 6, 8)).empty_area_fraction, 0.65 * 0.7, 0.06);
}

TEST(SolveWithGapRegularizationTest, ScalesWithTheHeights) {
  const FittingProblem problem = Measured(Wild, OutsideAHole, 7, 15);
  auto data = std::make_shared<FittingData>(problem.data());
  data->values *= 1024;
  const GapRegularizationResult one = Regularized(problem);
  const GapRegularizationResult other =
      Regularized(FittingProblem(problem.basis_u(), problem.basis_v(), data, problem.smoothing()));
  EXPECT_EQ(other.places_held, one.places_held);
  ASSERT_EQ(other.problem.net_size(), one.problem.net_size());
  EXPECT_LE((other.solution.coefficients - 1024 * one.solution.coefficients).cwiseAbs().maxCoeff(),
            kIterated * 1024);
}

TEST(SolveWithGapRegularizationTest, GivesTheSameBitsForEveryNumberOfThreads) {
  const FittingProblem problem = Measured(Wild, OutsideAHole, 8, 15);
  const GapRegularizationResult one = Regularized(problem, 1);
  for (const int threads : {2, 3}) {
    EXPECT_EQ(Regularized(problem, threads).solution.coefficients, one.solution.coefficients);
  }
}

TEST(SolveWithGapRegularizationTest, KeepsLevelDataLevel) {
  const FittingProblem problem = Measured([](double, double) { return 7; }, OutsideAHole, 9, 15, 0);
  const auto [least, greatest] = RangeOf(problem, Regularized(problem).solution.coefficients);
  EXPECT_NEAR(least, 7, kHalfDigits);
  EXPECT_NEAR(greatest, 7, kHalfDigits);
}

// Franke's function at a hundred thousand places, a disc left out: over a peak, on a slope, on the
// lower peak and across the border of the domain.
TEST(SolveWithGapRegularizationTest, FillsAHoleInFrankesFunction) {
  constexpr int kMany = 100000, kAcross = 300;
  constexpr double kRadius = 0.15;
  ThreadPool pool(2);
  const auto cloud = [&](double cu, double cv) {
    std::mt19937_64 engine(1);
    std::uniform_real_distribution<double> uniform;
    std::normal_distribution<double> normal(0, 1e-3);
    auto data = std::make_shared<FittingData>();
    data->parameters.resize(2, kMany);
    data->values.resize(1, kMany);
    Eigen::Index count = 0;
    for (int k = 0; k < kMany; ++k) {
      const double u = uniform(engine), v = uniform(engine), noise = normal(engine);
      if (std::hypot(u - cu, v - cv) < kRadius) continue;
      data->parameters.col(count) << u, v;
      data->values(0, count++) = Franke(u, v) + noise;
    }
    data->parameters.conservativeResize(2, count);
    data->values.conservativeResize(1, count);
    const SplineBasis basis = SplineBasis::Uniform(3, 22, 0, 1);
    return FittingProblem(basis, basis, std::move(data), 1e-4);
  };
  auto grid = std::make_shared<FittingData>();
  grid->parameters.resize(2, kAcross * kAcross);
  for (int k = 0; k < kAcross * kAcross; ++k)
    grid->parameters.col(k) << (k / kAcross + 0.5) / kAcross, (k % kAcross + 0.5) / kAcross;
  grid->values = Eigen::MatrixXd::Zero(1, kAcross * kAcross);
  const FittingProblem whole = cloud(9, 9);
  const Eigen::MatrixXd full =
      EvaluateAt(whole.WithData(grid), SolveLinear(whole, pool).coefficients, pool);
  for (const auto& [cu, cv] :
       {std::pair{2.0 / 9, 2.0 / 9}, {0.5, 0.5}, {7.0 / 9, 3.0 / 9}, {0.45, 0.75}, {0.05, 0.5}}) {
    SCOPED_TRACE(std::to_string(cu) + ", " + std::to_string(cv));
    const FittingProblem problem = cloud(cu, cv);
    const GapRegularizationResult calm = SolveWithGapRegularization(
        problem, {.spacing = 1 / 316.0, .measured = problem.size()}, pool);
    const Eigen::MatrixXd at =
        EvaluateAt(calm.problem.WithData(grid), calm.solution.coefficients, pool);
    double least = 9, greatest = -9, off = 0, off_full = 0, low = 9, high = -9;
    for (Eigen::Index k = 0; k < at.cols(); ++k) {
      const double u = grid->parameters(0, k), v = grid->parameters(1, k);
      if (std::hypot(u - cu, v - cv) < kRadius) {
        least = std::min(least, at(0, k));
        greatest = std::max(greatest, at(0, k));
      } else {
        off += std::pow(at(0, k) - Franke(u, v), 2);
        off_full += std::pow(full(0, k) - Franke(u, v), 2);
      }
    }
    for (int k = 0; k < 1000; ++k) {
      const double angle = 2 * std::numbers::pi * k / 1000;
      const double u = cu + kRadius * std::cos(angle), v = cv + kRadius * std::sin(angle);
      if (u < 0) continue;
      low = std::min(low, Franke(u, v));
      high = std::max(high, Franke(u, v));
    }
    EXPECT_GE(least, low - 0.1 * (high - low));
    EXPECT_LE(greatest, high + 0.1 * (high - low));
    EXPECT_LE(std::sqrt(off), 1.05 * std::sqrt(off_full));
  }
}

// Points of a bent sheet, or of a height field: three rows.
FittingProblem Sheet(const std::function<Eigen::Vector3d(double, double)>& at,
                     const Where& where,
                     unsigned seed,
                     int size,
                     double smoothing,
                     const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity(),
                     const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) {
  const FittingProblem heights = Measured([](double, double) { return 0; }, where, seed, size, 0);
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0, 1e-3);
  auto data = std::make_shared<FittingData>(heights.data());
  data->values.resize(3, kPoints);
  for (Eigen::Index k = 0; k < kPoints; ++k) {
    const Eigen::Vector3d noise(normal(engine), normal(engine), normal(engine));
    data->values.col(k) =
        turn * (at(data->parameters(0, k), data->parameters(1, k)) + noise) + shift;
  }
  return heights.WithData(data).WithSmoothing(smoothing);
}

Eigen::Vector3d Arch(double u, double v) {
  const double angle = 3 * (u - 0.5);
  return {std::sin(angle) / 3, v, std::cos(angle) / 3 + 0.02 * std::sin(9 * v)};
}

double FarthestInGap(const GapRegularizationResult& result, const Where& where) {
  ThreadPool pool(1);
  constexpr int kAcross = 101;
  auto dense = std::make_shared<FittingData>();
  dense->parameters.resize(2, kAcross * kAcross);
  for (int k = 0; k < kAcross * kAcross; ++k)
    dense->parameters.col(k) << k / kAcross / (kAcross - 1.0), k % kAcross / (kAcross - 1.0);
  dense->values = Eigen::MatrixXd::Zero(3, kAcross * kAcross);
  const Eigen::MatrixXd at =
      EvaluateAt(result.problem.WithData(dense), result.solution.coefficients, pool);
  double farthest = 0;
  for (Eigen::Index k = 0; k < at.cols(); ++k) {
    const double u = dense->parameters(0, k), v = dense->parameters(1, k);
    if (!where(u, v)) farthest = std::max(farthest, (at.col(k) - Arch(u, v)).norm());
  }
  return farthest;
}

TEST(SolveCalmlyOfPointsTest, LeavesACalmSheetAlone) {
  ThreadPool pool(1);
  for (const Where& where : {Where(Anywhere), Where(OutsideAHole)}) {
    const FittingProblem problem = Sheet(Arch, where, 11, 10, 1e-4);
    const GapRegularizationResult result = Regularized(problem);
    EXPECT_EQ(result.gaps_held, 0);
    EXPECT_EQ(result.solution.coefficients, SolveLinear(problem, pool).coefficients);
    EXPECT_LT(FarthestInGap(result, where), 0.05);
  }
}

TEST(SolveCalmlyOfPointsTest, HoldsWhatHardlyAnySmoothingLeavesFree) {
  ThreadPool pool(1);
  for (const auto& [name, where] :
       {std::pair<const char*, Where>{"hole", OutsideAHole}, {"L", InAnL}}) {
    SCOPED_TRACE(name);
    const FittingProblem problem = Sheet(Arch, where, 12, 30, 1e-12);
    const GapRegularizationResult free{problem, SolveLinear(problem, pool)};
    ASSERT_GT(FarthestInGap(free, where), 1) << "the case is meant to shoot out";
    const GapRegularizationResult calm = Regularized(problem);
    EXPECT_GT(calm.gaps_held, 0);
    // Less than the void is wide, though the sheet bends away by two radians in the L's.
    EXPECT_LT(FarthestInGap(calm, where), 0.75);
  }
}

TEST(SolveCalmlyOfPointsTest, TurnsAndMovesWithThePoints) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift(3, -2, 7);
  const GapRegularizationResult one = Regularized(Sheet(Arch, OutsideAHole, 13, 30, 1e-10));
  const GapRegularizationResult other =
      Regularized(Sheet(Arch, OutsideAHole, 13, 30, 1e-10, turn, shift));
  ASSERT_GT(one.gaps_held, 0);
  ASSERT_EQ(other.problem.net_size(), one.problem.net_size());
  const Eigen::MatrixXd expected = (turn * one.solution.coefficients).colwise() + shift;
  // Hardly any smoothing: rounding of 1e-15 grows with the matrix' condition of some 10⁹.
  EXPECT_LE((other.solution.coefficients - expected).cwiseAbs().maxCoeff(),
            kHalfDigits * expected.cwiseAbs().maxCoeff());
}

// Heights with their places as points: what shoots out by forty ranges as heights does so as
// points.
TEST(SolveCalmlyOfPointsTest, HoldsAHeightFieldLikeHeights) {
  ThreadPool pool(1);
  const FittingProblem heights = Measured(Peak, OutsideAHole, 14, 40, 1e-3).WithSmoothing(1e-10);
  auto data = std::make_shared<FittingData>(heights.data());
  data->values.resize(3, kPoints);
  data->values.topRows(2) = heights.data().parameters;
  data->values.row(2) = heights.data().values;
  const FittingProblem points = heights.WithData(data);
  const auto in_the_gap = [](double u, double v) { return !OutsideAHole(u, v); };
  const GapRegularizationResult of_heights = Regularized(heights), of_points = Regularized(points);
  ASSERT_LT(RangeOf(heights, SolveLinear(heights, pool).coefficients, in_the_gap).first, -1);
  const auto [low, high] =
      RangeOf(of_heights.problem, of_heights.solution.coefficients, in_the_gap);
  const auto [least, greatest] =
      RangeOf(of_points.problem, of_points.solution.coefficients.row(2), in_the_gap);
  // Points may go on as their slope says, half the way into the void; heights may not.
  EXPECT_GE(least, low - 0.2);
  EXPECT_LE(greatest, 1.2);
  EXPECT_GT(greatest, high - 0.2);
  for (const int row : {0, 1}) {  // and the net stays in place
    const Eigen::MatrixXd net = of_points.solution.coefficients.row(row);
    for (int i = 0; i < of_points.problem.basis_u().size(); ++i) {
      for (int j = 0; j < of_points.problem.basis_v().size(); ++j) {
        EXPECT_NEAR(net(0, Eigen::Index{i} * of_points.problem.basis_v().size() + j),
                    row == 0 ? of_points.problem.basis_u().Greville(i)
                             : of_points.problem.basis_v().Greville(j),
                    1e-3);
      }
    }
  }
}

TEST(SolveWithGapRegularizationTest, RefusesWhatIsNoOpenSheet) {
  ThreadPool pool(1);
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Random(2, 50).cwiseAbs();
  data->values = Eigen::MatrixXd::Random(2, 50);
  const SplineBasis basis = SplineBasis::Uniform(3, 6, 0, 1);
  EXPECT_THROW(
      SolveWithGapRegularization(FittingProblem(basis, basis, data, 1e-4), {0.1, 50}, pool),
      std::invalid_argument);
  EXPECT_THROW(SolveWithGapRegularization(FittingProblem(basis, data, 1e-4), {0.1, 50}, pool),
               std::invalid_argument);
}

}  // namespace batten::internal::gap_regularization_test
