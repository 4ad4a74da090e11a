// SPDX-License-Identifier: MIT
#include "fitting/flattening/tube_chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "tubes.h"
#include "angles.h"

namespace batten::internal::tube_chart_test {

// A periodic spline through a tube whose own parameters (u, v) stand where `skewed` puts them:
// period 3 in u, from 0 to 2 in v.
NurbsSurface SurfaceOf(const BentSheet& sheet,
                       const std::function<Eigen::Vector2d(double, double)>& skewed,
                       ThreadPool& pool) {
  constexpr int kSide = 120, kCells = 24;
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, kSide * (kSide + 1));
  data->values.resize(3, kSide * (kSide + 1));
  Eigen::Index next = 0;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j <= kSide; ++j) {
      const double u = 1.0 * i / kSide, v = 1.0 * j / kSide;
      const Eigen::Vector2d at = skewed(u, v);
      data->parameters.col(next) << 3 * (at[0] - std::floor(at[0])), 2 * at[1];
      data->values.col(next++) = sheet.at(u, v);
    }
  }
  std::vector<double> knots;
  for (int i = -5; i <= kCells + 5; ++i) knots.push_back(3.0 * i / kCells);
  const FittingProblem problem(SplineBasis::Periodic(5, std::move(knots)),
                               SplineBasis::Uniform(5, kCells + 5, 0, 2),
                               std::move(data),
                               1e-12);
  return {problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool).coefficients};
}

// Splines of 16 cells round follow the first harmonics of the angle to some 1e-4.
constexpr double kOfLength = 2e-3;

void ExpectAnglesAndLengths(const BentSheet& sheet,
                            double round,
                            double along,
                            const std::function<double(double)>& length) {
  SCOPED_TRACE(sheet.name);
  ThreadPool pool(2);
  const auto skewed = [](double u, double v) {
    return Eigen::Vector2d(u + 0.03 * std::sin(2 * kPi * u) + 0.05 * v,
                           v + 0.04 * std::sin(2 * kPi * u) * v * (1 - v));
  };
  const TubeChart chart(SurfaceOf(sheet, skewed, pool));
  EXPECT_NEAR(chart.length_round(), round, kOfLength * round);
  EXPECT_NEAR(chart.length_along(), along, kOfLength * along);
  EXPECT_EQ(chart.folded(), 0);
  constexpr int kSide = 20;
  double first = 0;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j <= kSide; ++j) {
      const double u = 1.0 * i / kSide, v = 1.0 * j / kSide;
      const Eigen::Vector2d at = skewed(u, v);
      const Eigen::Vector2d found =
          chart.At(Eigen::Vector2d(3 * (at[0] - std::floor(at[0])), 2 * at[1]), pool);
      if (i == 0 && j == 0) first = found[0];
      const double way = (found[0] - first) / round - u;
      EXPECT_NEAR(way - std::round(way), 0, kOfLength) << u << ", " << v;
      EXPECT_NEAR(found[1], length(v), kOfLength * along) << u << ", " << v;
    }
  }
}

TEST(TubeChartTest, IsTheAnglesOfAPipeBentInACircle) {
  // ∫ (a |∇θ| − 1)² over the pipe, |∇θ| = 1/(R + r cos φ), is least for a = 2π/∫ 1/(R + r cos φ).
  const double mean = std::sqrt(2.5 * 2.5 - 1);
  const double along = mean * kPi / 2;
  // Areas weigh: a = ∫ 1 / ∫ 1/ρ.
  ExpectAnglesAndLengths(Elbow(90), 2 * kPi, along, [=](double v) { return along * v; });
}

TEST(TubeChartTest, IsAngleAndProfileLengthOfAConeAndACylinder) {
  ExpectAnglesAndLengths(StraightTube(3), 2 * kPi, 3, [](double v) { return 3 * v; });
  // Areas weigh radii ρ = 1 … 2 of a cone by ρ: a = ∫ 1 / ∫ 1/ρ = 1/ln 2.
  ExpectAnglesAndLengths(
      StraightTube(4, 1, 2), 2 * kPi / std::numbers::ln2, std::sqrt(17.0), [](double v) {
        return std::sqrt(17.0) * v;
      });
}

TEST(TubeChartTest, TellsHowMuchLengthsChange) {
  ThreadPool pool(2);
  const auto plain = [](double u, double v) { return Eigen::Vector2d(u, v); };
  EXPECT_LE(TubeChart(SurfaceOf(StraightTube(3), plain, pool)).distortion(), 1e-3);
  const double ratio = TubeChart(SurfaceOf(StraightTube(4, 1, 2), plain, pool)).distortion() /
                       TubeChart(SurfaceOf(StraightTube(4, 1, 1.5), plain, pool)).distortion();
  EXPECT_GT(ratio, 1.5);
}

}  // namespace batten::internal::tube_chart_test
