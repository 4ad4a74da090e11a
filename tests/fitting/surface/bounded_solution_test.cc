// SPDX-License-Identifier: MIT
#include "fitting/surface/bounded_solution.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "cases.h"
#include "fitting/surface/coefficient_bounds.h"
#include "known_clouds.h"

namespace batten::internal::bounded_solution_test {

using Height = std::function<double(double, double)>;
using Where = std::function<bool(double, double)>;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  double Normal() { return normal_(engine_); }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

std::shared_ptr<FittingData> Heights(
    const Height& height, const Where& where, int count, double sigma, Random& random) {
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, count);
  data->values.resize(1, count);
  for (int k = 0; k < count;) {
    const double u = random.Uniform(0, 1), v = random.Uniform(0, 1);
    if (!where(u, v)) continue;
    data->parameters.col(k) << u, v;
    data->values(0, k++) = height(u, v) + sigma * random.Normal();
  }
  return data;
}

FittingProblem Over(int degree, int cells, std::shared_ptr<const FittingData> data) {
  const SplineBasis basis = SplineBasis::Uniform(degree, cells + degree, 0, 1);
  return FittingProblem(basis, basis, std::move(data), 1e-4);
}

// Least and greatest value over the whole domain.
std::pair<double, double> RangeOf(const FittingProblem& problem, const Eigen::MatrixXd& net) {
  constexpr int kAcross = 201;
  auto dense = std::make_shared<FittingData>();
  dense->parameters.resize(2, kAcross * kAcross);
  for (int i = 0; i < kAcross; ++i)
    for (int j = 0; j < kAcross; ++j)
      dense->parameters.col(i * kAcross + j) << i / (kAcross - 1.0), j / (kAcross - 1.0);
  dense->values = Eigen::MatrixXd::Zero(1, kAcross * kAcross);
  ThreadPool pool(1);
  const Eigen::MatrixXd values = EvaluateAt(problem.WithData(dense), net, pool);
  return {values.minCoeff(), values.maxCoeff()};
}

BoundedSolution Bounded(const FittingProblem& problem, int threads = 1) {
  ThreadPool pool(threads);
  return SolveWithinBounds(problem, 1 / std::sqrt(4000.0), pool);
}

TEST(SolveWithinBoundsTest, LeavesSmoothDataAlone) {
  const auto anywhere = [](double, double) { return true; };
  for (const int degree : {1, 2, 3, 4, 5}) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(testing::Message() << "degree " << degree << ", seed " << seed);
      Random random(seed);
      const FittingProblem problem =
          Over(degree, 12, Heights(Franke, anywhere, 4000, 1e-3, random));
      const BoundedSolution bounded = Bounded(problem);
      EXPECT_EQ(bounded.held, 0);
      ThreadPool pool(1);
      EXPECT_EQ(bounded.solution.coefficients, SolveLinear(problem, pool).coefficients);
    }
  }
}

// Cliffs of any direction, cells without data round them and elsewhere: least squares alone leave
// the range of the data by a quarter of it in most cases, and by many times it.
TEST(SolveWithinBoundsTest, KeepsToTheDataUnderCliffsAndInHoles) {
  int leave = 0, wild = 0, cases = 0;
  for (unsigned seed = 1; seed <= static_cast<unsigned>(Cases(60)); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const double turn = random.Uniform(0, 2 * std::numbers::pi), x = std::cos(turn),
                 y = std::sin(turn);
    const auto along = [&](double u, double v) { return x * (u - 0.5) + y * (v - 0.5); };
    const double bend = random.Uniform(-2, 2), gap = random.Uniform(0, 0.05);
    const auto cliff = [&](double u, double v) {
      return (along(u, v) > 0 ? 1 : 0) + 0.1 * std::sin(9 * u + bend) * std::cos(7 * v);
    };
    const double hole_u = random.Uniform(0.2, 0.8), hole_v = random.Uniform(0.2, 0.8),
                 radius = random.Uniform(0.05, 0.2);
    const auto where = [&](double u, double v) {
      return std::abs(along(u, v)) > gap && std::hypot(u - hole_u, v - hole_v) > radius &&
             u + v < 1.9;
    };
    const FittingProblem problem =
        Over(3, random.Uniform(0, 1) < 0.5 ? 15 : 25, Heights(cliff, where, 4000, 0.005, random));
    const double low = problem.data().values.minCoeff(), high = problem.data().values.maxCoeff();
    ThreadPool pool(1);
    const auto free = RangeOf(problem, SolveLinear(problem, pool).coefficients);
    const auto range = RangeOf(problem, Bounded(problem).solution.coefficients);
    const double most = 0.25 * (high - low);
    EXPECT_GE(range.first, low - 3 * most);
    EXPECT_LE(range.second, high + 3 * most);
    leave += range.first < low - most || range.second > high + most ? 1 : 0;
    wild += free.first < low - most || free.second > high + most ? 1 : 0;
    ++cases;
  }
  EXPECT_LE(10 * leave, cases);  // at a cliff whose side is half covered
  EXPECT_GT(2 * wild, cases) << "the cases show nothing";
}

// A strip bent by 150 degrees with a hole, at the parameters it was made with.
FittingProblem Strip(const Eigen::Matrix3d& turn, const Eigen::Vector3d& move, unsigned seed) {
  Random random(seed);
  auto data = std::make_shared<FittingData>();
  constexpr int kCount = 3000;
  data->parameters.resize(2, kCount);
  data->values.resize(3, kCount);
  for (int k = 0; k < kCount;) {
    const double u = random.Uniform(0, 1), v = random.Uniform(0, 1);
    if (std::hypot(u - 0.5, v - 0.5) < 0.2 || std::hypot(u - 0.5, v - 0.5) > 0.5) continue;
    const double angle = 2.6 * u, step = u > 0.75 ? 0.2 : 0;
    data->parameters.col(k) << u, v;
    data->values.col(k++) =
        turn * Eigen::Vector3d((1 + step) * std::cos(angle), (1 + step) * std::sin(angle), v) +
        move;
  }
  return Over(3, 24, data);
}

TEST(SolveWithinBoundsTest, TurnsAndMovesWithThePoints) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();
  const Eigen::Vector3d move(3, -7, 2);
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const BoundedSolution one = Bounded(Strip(Eigen::Matrix3d::Identity(), {0, 0, 0}, seed)),
                          other = Bounded(Strip(turn, move, seed));
    EXPECT_GT(one.held, 0);
    const Eigen::Matrix3Xd back =
        turn.transpose() * (other.solution.coefficients.colwise() - move).matrix();
    EXPECT_LT((back - one.solution.coefficients).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(SolveWithinBoundsTest, IsTheSameOnAnyNumberOfThreads) {
  const FittingProblem problem = Strip(Eigen::Matrix3d::Identity(), {0, 0, 0}, 1);
  EXPECT_EQ(Bounded(problem, 1).solution.coefficients, Bounded(problem, 3).solution.coefficients);
}

// A coefficient is the polar form of the polynomial at the knots inside its support. A polynomial
// that rises in u and v has its range at the corners of a support, so where these cells hold data,
// its coefficient is within the bounds, among unequal knots and at clamped ends too.
TEST(BoundsFromDataTest, AllowEveryPolynomialWhoseRangeTheDataShow) {
  ThreadPool pool(1);
  int bounded = 0;
  for (unsigned seed = 1; seed <= static_cast<unsigned>(Cases(40)); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const int degree = 2 + static_cast<int>(seed % 4);
    std::vector<double> breaks{0};
    for (int k = 0; k < 8; ++k) breaks.push_back(breaks.back() + random.Uniform(0.05, 0.2));
    for (double& one : breaks) one /= breaks.back();
    breaks.back() = 1;
    const SplineBasis basis = SplineBasis::Clamped(degree, breaks);
    Eigen::MatrixXd factors(degree + 1, 2);
    for (Eigen::Index k = 0; k < factors.size(); ++k) factors(k) = random.Uniform(0, 1);
    const auto polynomial = [&](double u, double v) {
      double a = 0, b = 0;
      for (int k = degree; k >= 0; --k) {
        a = a * u + factors(k, 0);
        b = b * v + factors(k, 1);
      }
      return a * b;
    };
    const auto in_empty_cell = [&](double u, double v) {
      return u > breaks[3] && u < breaks[4] && v > breaks[4] && v < breaks[5];
    };
    const FittingProblem problem(
        basis,
        basis,
        Heights(
            polynomial, [&](double u, double v) { return !in_empty_cell(u, v); }, 40000, 0, random),
        1e-14);
    const Eigen::MatrixXd net = SolveLinear(problem, pool).coefficients;
    const CoefficientBounds bounds =
        BoundsFromData(problem, Eigen::MatrixXd::Zero(1, problem.net_size()), 0, pool);
    const auto is_inner = [&](int function, int cell) {  // of the function's cells
      const int first = std::max(0, function - degree), last = std::min(7, function);
      return cell > first && cell < last;
    };
    for (int i = 0; i < basis.size(); ++i) {
      for (int j = 0; j < basis.size(); ++j) {
        const Eigen::Index k = Eigen::Index{i} * basis.size() + j;
        if (!std::isfinite(bounds.low[k]) || (!is_inner(i, 3) && !is_inner(j, 4))) continue;
        const double near_corners = 0.03 * (bounds.high[k] - bounds.low[k]);  // no datum is at one
        EXPECT_GE(net(0, k), bounds.low[k] - near_corners) << i << ", " << j;
        EXPECT_LE(net(0, k), bounds.high[k] + near_corners) << i << ", " << j;
        ++bounded;
      }
    }
  }
  EXPECT_GT(bounded, 100);
}

// The corners that a tapered, swept outline leaves empty ask for coefficients far from all heights:
// held nearer, they would draw the surface off its points.
TEST(SolveWithinBoundsTest, CostsNoMoreThanChanceOverATaperedOutline) {
  constexpr int kCount = 20000;
  constexpr double kSigma = 5e-4, kMatters = 4e-3;
  const auto across = [](double u, double v) { return (v - 0.4 * u) / (0.6 * (1 - 0.5 * u)); };
  const auto inside = [&](double u, double v) { return across(u, v) > 0 && across(u, v) < 1; };
  const auto wing = [&](double u, double v) {
    const double t = across(u, v);
    return 0.06 * (1 - 0.5 * u) * t * (1 - t) + 0.05 * u * u;
  };
  Random random(7);
  for (const int cells : {1, 2, 3}) {
    const FittingProblem problem = Over(3, cells, Heights(wing, inside, kCount, kSigma, random));
    ThreadPool pool(1);
    const double free = SolveLinear(problem, pool).residual_squares;
    const BoundedSolution held =
        SolveWithinBounds(problem, 1 / std::sqrt(kCount), pool, HUGE_VAL, kSigma);
    EXPECT_LE(held.solution.residual_squares, (1 + kMatters) * free) << cells;
  }
}

// A round outline leaves the corners empty, where a steep surface goes far beyond the box of its
// points; coarse cells reach from there to the middle.
TEST(SolveWithinBoundsTest, CostsNoMoreThanChanceWithinARoundOutline) {
  constexpr int kCount = 15000;
  constexpr double kSigma = 2e-3;
  const auto inside = [](double u, double v) { return std::hypot(u - 0.5, v - 0.5) < 0.5; };
  const auto dish = [](double u, double v) {
    const double x = u - 0.5, y = v - 0.5;
    return 0.8 * (x * x + y * y) + 0.9 * x * y * (x + y) + 0.2 * x;
  };
  Random random(11);
  for (const int cells : {1, 3, 4}) {
    const FittingProblem problem = Over(3, cells, Heights(dish, inside, kCount, kSigma, random));
    ThreadPool pool(1);
    const double free = SolveLinear(problem, pool).residual_squares;
    const BoundedSolution held = SolveWithinBounds(problem, 1 / std::sqrt(kCount), pool, 0, kSigma);
    const double chance = std::max<double>(6 * held.held, 0.4 * problem.unknowns()) / kCount;
    EXPECT_LE(held.solution.residual_squares, (1 + chance) * free) << cells;
  }
}

}  // namespace batten::internal::bounded_solution_test
