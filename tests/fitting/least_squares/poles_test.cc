// SPDX-License-Identifier: MIT
#include "batten/fitting/poles.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>

#include "angles.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/surface_evaluator.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/least_squares/penalised_system.h"
#include "fitting/linear/coefficient_order.h"

namespace batten::internal::poles_test {

// Bases and poles of many kinds.
struct Case {
  SplineBasis u, v;
  Poles poles;
};
Case RandomCase(std::mt19937_64& random) {
  const int p = 1 + static_cast<int>(random() % 4), q = 1 + static_cast<int>(random() % 4);
  const bool round = random() % 2 == 0;
  const int cells_u = p + 1 + static_cast<int>(random() % 8);
  const int cells_v = 3 + static_cast<int>(random() % 6);
  Poles poles;
  const auto kind = [&] { return static_cast<PoleKind>(random() % 3); };
  poles.start = kind();
  poles.end = kind();
  poles.turn = round ? 2 * kPi : 1 + static_cast<double>(random() % 4);
  return {round ? PeriodicUniformKnots(p, cells_u, 0, 7) : FittingBasis(p, cells_u, 0, 7),
          FittingBasis(q, cells_v, 0, 3),
          poles};
}

Eigen::MatrixXd RandomNet(int rows, const Case& c, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd net(rows, c.u.size() * c.v.size());
  for (double& x : net.reshaped()) x = normal(random);
  for (int i = 0; i < c.u.size(); ++i)
    for (int j = 0; j < c.v.size(); ++j)
      net.col(i * c.v.size() + j) = net.col(DistinctIndex(c.u, i) * c.v.size() + j);
  return net;
}

Eigen::MatrixXd Distinct(const Eigen::MatrixXd& net, const Case& c) {
  return net.leftCols(Eigen::Index{DistinctCount(c.u)} * c.v.size());
}

TEST(PolesTest, ConditionsAreIndependentAndAsManyAsSaid) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    const Case c = RandomCase(random);
    const Eigen::MatrixXd conditions = PoleConditions(c.u, c.v, c.poles);
    EXPECT_EQ(conditions.rows(), PoleConditionCount(c.u, c.v, c.poles));
    if (conditions.rows() == 0) continue;
    EXPECT_EQ(conditions.colPivHouseholderQr().rank(), conditions.rows());
  }
}

TEST(PolesTest, ClosedPolesMeetTheConditionsAndStayAsTheyAre) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    const Case c = RandomCase(random);
    const Eigen::MatrixXd net = RandomNet(3, c, random);
    const Eigen::MatrixXd closed = WithPolesClosed(net, c.u, c.v, c.poles);
    const Eigen::MatrixXd conditions = PoleConditions(c.u, c.v, c.poles);
    if (conditions.rows() == 0) {
      EXPECT_EQ(closed, net);
      continue;
    }
    // Sums of a few dozen numbers of size one.
    EXPECT_LT((conditions * Distinct(closed, c).transpose()).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_LT((WithPolesClosed(closed, c.u, c.v, c.poles) - closed).cwiseAbs().maxCoeff(), 1e-13);
    for (int i = 1; i < c.u.size(); ++i) {
      const Eigen::Index row = Eigen::Index{i} * c.v.size();
      if (c.poles.start != PoleKind::kNone) {
        EXPECT_EQ(closed.col(row), closed.col(0));
      }
      if (c.poles.end != PoleKind::kNone) {
        EXPECT_EQ(closed.col(row + c.v.size() - 1), closed.col(c.v.size() - 1));
      }
    }
  }
}

// The forms are as many as conditions leave, and meet them.
TEST(PolesTest, WhatIsFreeMeetsTheConditions) {
  std::mt19937_64 random(6);
  for (int trial = 0; trial < 120; ++trial) {
    SCOPED_TRACE(trial);
    Case c = RandomCase(random);
    const bool narrow = trial % 4 == 0;
    if (narrow) c.poles.turn = 1e-3;
    const PoleFreedom freedom = FreeVariablesOf(c.u, c.v, c.poles);
    const Eigen::MatrixXd conditions = PoleConditions(c.u, c.v, c.poles);
    const Eigen::Index m = DistinctCount(c.u), size_v = c.v.size();
    EXPECT_EQ(std::ssize(freedom.rows) * m - freedom.unknowns, conditions.rows());
    Eigen::MatrixXd forms = Eigen::MatrixXd::Zero(m * size_v, freedom.unknowns);
    for (const TiedRow& row : freedom.rows)
      forms(Eigen::seqN(row.j, m, size_v), Eigen::seqN(row.first, row.form.cols())) = row.form;
    const Eigen::MatrixXd products = forms.transpose() * forms;
    EXPECT_LT((products - Eigen::MatrixXd::Identity(products.rows(), products.cols())).norm(),
              1e-12);
    for (Eigen::Index k = 0; k < conditions.rows(); ++k)
      EXPECT_LT((conditions.row(k) * forms).norm(),
                1e-13 * std::max(1.0, conditions.row(k).norm()));
  }
}

// A dense decomposition takes 40 s here, this one a hundredth of a second.
TEST(PolesTest, ThousandsOfPointsAroundArePlacedAtOnce) {
  const SplineBasis u = PeriodicUniformKnots(3, 4000, 0, 7), v = FittingBasis(3, 6, 0, 3);
  const Poles poles{PoleKind::kSmooth, PoleKind::kNone, 2 * kPi};
  const auto begin = std::chrono::steady_clock::now();
  const PoleFreedom freedom = FreeVariablesOf(u, v, poles);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  ASSERT_EQ(freedom.rows.size(), 3u);
  EXPECT_EQ(freedom.unknowns, 8);  // the pole and two slopes; five of the row after
  for (const TiedRow& row : freedom.rows) {
    // Splines over uniform knots have the harmonics of their values.
    for (const Eigen::VectorXd& column : row.form.colwise()) {
      Eigen::VectorXd left = column;
      for (int k = 0; k <= (row.j == 2 ? 2 : 1); ++k) {
        Eigen::MatrixXd wave(left.size(), k == 0 ? 1 : 2);
        for (Eigen::Index i = 0; i < left.size(); ++i) {
          const double angle = 2 * kPi * k * static_cast<double>(i) / left.size();
          wave(i, 0) = std::cos(angle);
          if (k > 0) wave(i, 1) = std::sin(angle);
        }
        left -= wave *
                (wave.transpose() * left).cwiseQuotient(wave.colwise().squaredNorm().transpose());
      }
      EXPECT_LT(left.norm(), 1e-11);
    }
  }
}

// Over so little of a turn the harmonics are the same to rounding.
TEST(PolesTest, NarrowSlicesKeepTheirConditionsApart) {
  std::mt19937_64 random(5);
  for (const double turn : {0.1, 1e-2, 1e-3, 1e-4}) {
    SCOPED_TRACE(turn);
    const Case c{FittingBasis(3, 9, 0, 7),
                 FittingBasis(3, 6, 0, 3),
                 {PoleKind::kSmooth, PoleKind::kSmooth, turn}};
    Eigen::MatrixXd conditions = PoleConditions(c.u, c.v, c.poles);
    ASSERT_EQ(conditions.rows(), PoleConditionCount(c.u, c.v, c.poles));
    conditions.rowwise().normalize();
    EXPECT_EQ(conditions.colPivHouseholderQr().rank(), conditions.rows());
    const Eigen::MatrixXd closed = WithPolesClosed(RandomNet(3, c, random), c.u, c.v, c.poles);
    // What is the same all round is told from a cosine, 1 − φ²/2, by its square only.
    EXPECT_LT((conditions * Distinct(closed, c).transpose()).cwiseAbs().maxCoeff(),
              1e-13 / (turn * turn));
  }
}

TEST(PolesTest, TheAngleAboutAPoleIsPositive) {
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Constant(2, 5, 0.5);
  data->values = Eigen::MatrixXd::Ones(3, 5);
  const FittingProblem problem(FittingBasis(3, 4, 0, 1), FittingBasis(3, 4, 0, 1), data, 1e-4);
  for (const double turn : {0.0, -1.0, HUGE_VAL, std::nan("")}) {
    EXPECT_THROW((void)problem.WithPoles({PoleKind::kSmooth, PoleKind::kNone, turn}),
                 std::invalid_argument);
  }
}

// By a dense system with one multiplier for each condition.
TEST(PolesTest, TheSolutionIsTheLeastUnderTheConditions) {
  std::mt19937_64 random(3);
  ThreadPool pool(2);
  for (int trial = 0; trial < 20; ++trial) {
    SCOPED_TRACE(trial);
    const Case c = RandomCase(random);
    auto data = std::make_shared<FittingData>();
    const Eigen::Index m = 600;
    data->parameters = (Eigen::Array2Xd::Random(2, m) + 1) / 2;
    data->parameters.row(0) *= 7;
    data->parameters.row(1) *= 3;
    data->values = Eigen::MatrixXd::Random(3, m);
    const FittingProblem problem =
        FittingProblem(c.u, c.v, std::move(data), 1e-3).WithPoles(c.poles);
    const LinearSolution found = SolveLinear(problem, pool);
    const PenalisedSystem system(problem, pool);
    const Eigen::Index n = system.unknowns();
    const Eigen::MatrixXd matrix = system.Matrix(1e-3, 1).Times(Eigen::MatrixXd::Identity(n, n));
    const Eigen::MatrixXd on_net = PoleConditions(c.u, c.v, c.poles);
    Eigen::MatrixXd conditions(on_net.rows(), n);
    for (Eigen::Index k = 0; k < n; ++k) conditions.col(system.RowOf(k)) = on_net.col(k);
    const Eigen::Index all = n + conditions.rows();
    Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(all, all);
    kkt.topLeftCorner(n, n) = matrix;
    kkt.topRightCorner(n, conditions.rows()) = conditions.transpose();
    kkt.bottomLeftCorner(conditions.rows(), n) = conditions;
    Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(all, 3);
    rhs.topRows(n) = system.rhs();
    const Eigen::MatrixXd expected = system.Net(kkt.fullPivLu().solve(rhs).topRows(n));
    // Values of size one; the matrices' condition is below 1e6.
    EXPECT_LT((found.coefficients - expected).cwiseAbs().maxCoeff(), 1e-9);
    const double left =
        (EvaluateAt(problem, found.coefficients, pool) - problem.data().values).squaredNorm();
    EXPECT_NEAR(found.residual_squares, left, 1e-9 * left);
    EXPECT_EQ(problem.unknowns(), n - conditions.rows());
  }
}

// Points of an egg over angle and arc length, without noise.
std::shared_ptr<FittingData> Egg(Eigen::Index m, double cone) {
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, m);
  data->values.resize(3, m);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  for (Eigen::Index k = 0; k < m; ++k) {
    const double u = 2 * kPi * unit(random), v = kPi * unit(random);
    const double r = std::sin(v) * (1 + 0.1 * std::sin(v) * std::cos(2 * u));
    data->parameters.col(k) << u, v;
    data->values.col(k) << r * std::cos(u), r * std::sin(u), -std::cos(v) + cone * v;
  }
  return data;
}

TEST(PolesTest, NormalsAreRightAtSmoothPoles) {
  ThreadPool pool(2);
  const FittingProblem problem =
      FittingProblem(
          PeriodicUniformKnots(3, 16, 0, 2 * kPi), FittingBasis(3, 10, 0, kPi), Egg(20000, 0), 1e-9)
          .WithPoles({PoleKind::kSmooth, PoleKind::kSmooth, 2 * kPi});
  const Eigen::MatrixXd net = WithPolesClosed(SolveLinear(problem, pool).coefficients,
                                              problem.basis_u(),
                                              problem.basis_v(),
                                              problem.poles());
  const NurbsSurface surface(problem.basis_u(), problem.basis_v(), net);
  const SurfaceEvaluator evaluator(surface);
  for (const auto& [v, side] : {std::pair{0.0, -1.0}, {kPi, 1.0}}) {
    for (int k = 0; k < 32; ++k) {
      const double u = 2 * kPi * k / 32;
      const auto normal = evaluator.NormalAt(u, v);
      ASSERT_TRUE(normal);
      // The tangents' plane is exact but for the splines nearest to cosine and sine.
      EXPECT_LT((*normal - Eigen::Vector3d(0, 0, side)).norm(), 1e-3) << u;
      EXPECT_LT((surface.At(u, v) - Eigen::Vector3d(0, 0, side)).norm(), 1e-3);
    }
  }
}

TEST(PolesTest, AnApexKeepsItsCone) {
  ThreadPool pool(2);
  const auto egg = Egg(20000, 1.0);
  const auto left = [&](PoleKind kind) {
    const FittingProblem problem =
        FittingProblem(
            PeriodicUniformKnots(3, 12, 0, 2 * kPi), FittingBasis(3, 10, 0, kPi), egg, 1e-9)
            .WithPoles({kind, kind, 2 * kPi});
    return SolveLinear(problem, pool).residual_squares;
  };
  EXPECT_LT(10 * left(PoleKind::kApex), left(PoleKind::kSmooth));
}

}  // namespace batten::internal::poles_test
