// SPDX-License-Identifier: MIT
#include "fitting/foot_points/warm_start_foot_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "batten/geometry/foot_point.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::warm_start_foot_points_test {

template <int Dim>
void ExpectLocalMinima(RandomSplines& random) {
  BasisKind kind;
  kind.periodic = random.Coin();
  const NurbsCurve<Dim> curve = random.Curve<Dim>(random.Integer(1, 5), false, kind);
  const CurveEvaluator<Dim> evaluator(curve);
  const SplineBasis& basis = curve.basis();
  Eigen::Matrix<double, Dim, Eigen::Dynamic> points(Dim, 700);
  for (double& x : points.reshaped()) x = random.Real(-2, 2);
  Eigen::VectorXd start(points.cols());
  for (double& u : start) u = random.Parameter(basis);
  ThreadPool one(1), two(2);
  const WarmStartFootPoints<Dim> feet = FootPointsFrom<Dim>(evaluator, points, start, two);
  EXPECT_EQ(feet.parameters, (FootPointsFrom<Dim>(evaluator, points, start, one).parameters));
  const double length = basis.upper() - basis.lower();
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double u = feet.parameters[k], distance = feet.differences.col(k).norm();
    EXPECT_GE(u, basis.lower());
    EXPECT_LE(u, basis.upper());
    EXPECT_NEAR((curve.At(u) - points.col(k)).norm(), distance, kIterated);
    EXPECT_LE(distance, (curve.At(start[k]) - points.col(k)).norm() + kRounding);
    for (const double by : {-1e-6, 1e-6}) {
      const double beside = basis.Clamp(u + by * length);
      EXPECT_GE((curve.At(beside) - points.col(k)).norm(), distance - kIterated);
    }
    const double ulps = kRounding * length;
    const auto near = [&](double knot) { return std::abs(u - knot) < ulps; };
    const std::vector<double>& knots = basis.knots();
    const bool at_knot = std::any_of(knots.begin(), knots.end(), near);
    const bool cusp = std::abs(feet.bend[k]) > 1e3;
    if (!at_knot && !cusp) {
      EXPECT_LT(std::abs(feet.tangents.col(k).dot(feet.differences.col(k))), 1e-5 * distance);
    }
    EXPECT_TRUE(!feet.held[k] || at_knot);
  }
}

TEST(WarmStartFootPointsTest, AreLocalMinimaThatAreNoFartherThanTheStart) {
  RandomSplines random(1);
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE("seed 1, trial " + std::to_string(trial));
    ExpectLocalMinima<2>(random);
    ExpectLocalMinima<3>(random);
  }
}

TEST(WarmStartFootPointsTest, GoRoundTheSeamOfPeriodicCurves) {
  RandomSplines random(2);
  BasisKind kind;
  kind.periodic = true;
  kind.highest_multiplicity = 1;
  ThreadPool pool(1);
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE("seed 2, trial " + std::to_string(trial));
    const NurbsCurve<2> curve = random.Curve<2>(3, false, kind);
    const SplineBasis& basis = curve.basis();
    const double step = 1e-3 * (basis.upper() - basis.lower());
    const Eigen::Matrix2Xd behind = curve.At(basis.Clamp(basis.upper() - step));
    const WarmStartFootPoints<2> feet =
        FootPointsFrom<2>(CurveEvaluator<2>(curve),
                          behind,
                          Eigen::VectorXd::Constant(1, basis.lower() + step / 2),
                          pool);
    EXPECT_LT(feet.differences.norm(), kIterated);
    EXPECT_FALSE(feet.held[0]);
  }
}

TEST(WarmStartFootPointsTest, StayWhereTheCurveStandsStill) {
  const NurbsCurve<2> still(SplineBasis::Uniform(3, 6, 0, 1), Eigen::Matrix2Xd::Ones(2, 6));
  const Eigen::Matrix2Xd points{{0, 1, 5}, {0, 1, -3}};
  ThreadPool pool(1);
  const WarmStartFootPoints<2> feet =
      FootPointsFrom<2>(CurveEvaluator<2>(still), points, Eigen::Vector3d(0, 0.5, 1), pool);
  EXPECT_EQ(feet.parameters, Eigen::Vector3d(0, 0.5, 1));
  EXPECT_EQ(feet.tangents.norm(), 0);
  EXPECT_NEAR(feet.Squares({}), 2 + 32, kRounding * 34);
}

}  // namespace batten::internal::warm_start_foot_points_test
