// SPDX-License-Identifier: MIT
#include "fitting/ordering/row_means.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::row_means_test {

TEST(IncreasingRowTest, HasTheMeanOfEachParameterInOrder) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int count = random.Integer(1, 60);
    Eigen::Matrix3Xd points(3, count);
    Eigen::VectorXd parameters(count);
    std::map<double, std::pair<Eigen::Vector3d, int>> expected;
    for (int k = 0; k < count; ++k) {
      points.col(k) = random.Vector(2);
      parameters[k] = random.Coin() ? random.Integer(0, 5) : random.Real(0, 5);
      auto& [sum, number] =
          expected.try_emplace(parameters[k], Eigen::Vector3d::Zero(), 0).first->second;
      sum += points.col(k);
      ++number;
    }
    const RowMeans row = IncreasingRow(points, parameters);
    ASSERT_EQ(row.parameters.size(), static_cast<Eigen::Index>(expected.size()));
    ASSERT_EQ(row.points.cols(), row.parameters.size());
    Eigen::Index k = 0;
    for (const auto& [at, sum] : expected) {
      EXPECT_EQ(row.parameters[k], at);
      EXPECT_LE((row.points.col(k++) - sum.first / sum.second).norm(), kRounding);
    }
  }
}

TEST(IncreasingRowTest, LeavesWhatIsInStrictOrder) {
  Eigen::Matrix3Xd points(3, 100);
  RandomSplines random(1);
  for (auto point : points.colwise()) point = random.Vector(1);
  const Eigen::VectorXd parameters = Eigen::VectorXd::LinSpaced(100, -1, 3);
  const RowMeans row = IncreasingRow(points, parameters);
  EXPECT_EQ(row.points, points);
  EXPECT_EQ(row.parameters, parameters);
}

TEST(LengthPerParameterTest, IsTheSpeedOfAStraightRow) {
  for (const int count : {2, 3, 399, 400, 401, 5000}) {
    for (const double unit : {1e-6, 1.0, 1e6}) {
      const Eigen::VectorXd parameters = Eigen::VectorXd::LinSpaced(count, 2, 5);
      const Eigen::Vector3d speed(2, -1, 2);
      Eigen::Matrix3Xd points = unit * speed * parameters.transpose();
      points.colwise() += unit * Eigen::Vector3d(10, 20, 30);
      EXPECT_NEAR(LengthPerParameter(points, parameters), 3 * unit, kIterated * unit) << count;
    }
  }
}

TEST(LengthPerParameterTest, IsHardlyMoreOfANoisyCircle) {
  RandomSplines random(1);
  Eigen::Matrix3Xd points(3, 100000);
  Eigen::VectorXd parameters(100000);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    parameters[k] = 2 * std::numbers::pi * static_cast<double>(k) / 100000;
    points.col(k) << std::cos(parameters[k]), std::sin(parameters[k]), 0;
    points.col(k) += random.Vector(0.02);
  }
  // Means of 250: noise of 0.0116 / √250 a coordinate against steps of 0.0157, less than 1 %.
  EXPECT_NEAR(LengthPerParameter(points, parameters), 1, 0.01);
}

TEST(LengthPerParameterTest, IsOneWhereThereIsNoRange) {
  EXPECT_EQ(LengthPerParameter(Eigen::Matrix3Xd::Random(3, 10), Eigen::VectorXd::Ones(10)), 1);
  EXPECT_EQ(LengthPerParameter(Eigen::Matrix3Xd::Random(3, 1), Eigen::VectorXd::Ones(1)), 1);
}

FittingProblem RandomProblem(unsigned seed, int count, bool weighted) {
  RandomSplines random(seed);
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, count);
  data->values.resize(random.Integer(2, 3), count);
  for (int k = 0; k < count; ++k) data->parameters(0, k) = (k + 0.5) / count;
  for (double& x : data->values.reshaped()) x = random.Real(-1, 1);
  if (weighted) {
    data->weights.resize(count);
    for (double& w : data->weights) w = random.Integer(0, 3) == 0 ? 0 : random.Real(0.5, 2);
    data->weights[0] = 1;
  }
  return FittingProblem(SplineBasis::Uniform(3, 6, 0, 1), std::move(data), 1e-8);
}

TEST(MeansOfRowsTest, KeepsTheMomentsOfTheData) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const int size = 1 + static_cast<int>(seed) * 13;
    const FittingProblem all = RandomProblem(seed, size, seed % 2 == 0);
    for (const int count : {1, 7, 100}) {
      const FittingProblem means = MeansOfRows(all, count);
      const Eigen::Index blocks = std::min(count, size);
      ASSERT_EQ(means.size(), blocks);
      EXPECT_EQ(means.basis_u(), all.basis_u());
      EXPECT_EQ(means.smoothing(), all.smoothing());
      const Eigen::VectorXd weights =
          all.data().weights.size() > 0 ? all.data().weights : Eigen::VectorXd::Ones(size);
      const Eigen::VectorXd& w = means.data().weights;
      EXPECT_NEAR(w.mean(), 1, kRounding);
      const double scale = weights.sum() / w.sum();
      EXPECT_LE((scale * (means.data().values * w) - all.data().values * weights).norm(),
                kRounding * size);
      EXPECT_NEAR(scale * means.data().parameters.row(0).dot(w),
                  all.data().parameters.row(0).dot(weights),
                  kRounding * size);
    }
  }
}

TEST(MeansOfRowsTest, StaysInOrderAndInsideTheDomain) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const FittingProblem means = MeansOfRows(RandomProblem(seed, 500, true), 40);
    const Eigen::RowVectorXd u = means.data().parameters.row(0);
    EXPECT_TRUE(std::is_sorted(u.begin(), u.end()));
    EXPECT_GE(u.minCoeff(), 0);
    EXPECT_LE(u.maxCoeff(), 1);
  }
}

TEST(MeansOfRowsTest, LeavesFewDataAsTheyAre) {
  const FittingProblem all = RandomProblem(3, 30, true), means = MeansOfRows(all, 1000);
  ASSERT_EQ(means.size(), 30);
  const Eigen::VectorXd& weights = all.data().weights;
  EXPECT_LE((means.data().weights - weights / weights.mean()).norm(), kRounding);
  for (Eigen::Index k = 0; k < 30; ++k) {
    EXPECT_NEAR(means.data().parameters(0, k), all.data().parameters(0, k), kRounding);
    EXPECT_LE((means.data().values.col(k) - all.data().values.col(k)).norm(), kRounding);
  }
}

// A straight line's fit does not know whether it sees the points or their means.
TEST(MeansOfRowsTest, HasTheCurveOfTheDataWhereMeansLoseNothing) {
  FittingProblem all = RandomProblem(5, 900, false);
  auto data = std::make_shared<FittingData>(all.data());
  for (Eigen::Index k = 0; k < 900; ++k)
    data->values.col(k).setConstant(3 * data->parameters(0, k) - 1);
  all = all.WithData(data);
  ThreadPool pool(1);
  const Eigen::MatrixXd one = SolveLinear(all, pool).coefficients,
                        other = SolveLinear(MeansOfRows(all, 60), pool).coefficients;
  EXPECT_LE((one - other).cwiseAbs().maxCoeff(), kIterated);
}

}  // namespace batten::internal::row_means_test
