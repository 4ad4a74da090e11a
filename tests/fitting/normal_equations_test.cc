// SPDX-License-Identifier: MIT
#include "batten/fitting/normal_equations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

namespace batten {
namespace {

struct Case {
  SplineBasis outer, inner;
  Eigen::VectorXd u, v;  // outer and inner parameters
  Eigen::MatrixXd values;
  Eigen::VectorXd weights;  // may be empty
};

// Random degrees, knots and points; ends and knots among the parameters, zeros among the weights.
Case RandomCase(RandomSplines& random) {
  SplineBasis outer = random.Basis(random.Integer(1, 5), {.clamped = random.Coin()});
  SplineBasis inner = random.Basis(random.Integer(1, 5), {.clamped = random.Coin()});
  const int m = random.Integer(1, 150), d = random.Coin() ? 1 : 3;
  Eigen::VectorXd u(m), v(m), weights(random.Coin() ? m : 0);
  Eigen::MatrixXd values(d, m);
  for (double& t : u) t = random.Parameter(outer);
  for (double& t : v) t = random.Parameter(inner);
  for (double& z : values.reshaped()) z = random.Real(-1, 1);
  for (double& w : weights) w = random.Integer(0, 3) == 0 ? 0 : random.Real(0, 5);
  return {std::move(outer),
          std::move(inner),
          std::move(u),
          std::move(v),
          std::move(values),
          std::move(weights)};
}

void ForRandomCases(const std::function<void(const Case&)>& law) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    law(RandomCase(random));
    if (testing::Test::HasFailure()) return;
  }
}

NormalEquations Equations(const Case& c, int threads = 1) {
  ThreadPool pool(threads);
  return NormalEquations(c.outer,
                         &c.inner,
                         c.u,
                         c.v,
                         c.values,
                         c.weights,
                         CellOrder(c.outer, &c.inner, c.u, c.v),
                         pool);
}

// Row k: every tensor-product function at point k.
Eigen::MatrixXd Design(const Case& c) {
  Eigen::MatrixXd design = Eigen::MatrixXd::Zero(c.u.size(), c.outer.size() * c.inner.size());
  const int p = c.outer.degree(), q = c.inner.degree();
  std::vector<double> No(p + 1), Ni(q + 1);
  for (Eigen::Index k = 0; k < c.u.size(); ++k) {
    const int so = c.outer.Span(c.u[k]), si = c.inner.Span(c.v[k]);
    c.outer.Values(so, c.u[k], No.data());
    c.inner.Values(si, c.v[k], Ni.data());
    for (int r = 0; r <= p; ++r) {
      for (int s = 0; s <= q; ++s)
        design(k, (so - p + r) * c.inner.size() + si - q + s) = No[r] * Ni[s];
    }
  }
  return design;
}

Eigen::VectorXd Weights(const Case& c) {
  return c.weights.size() > 0 ? c.weights : Eigen::VectorXd::Ones(c.u.size());
}

Eigen::MatrixXd Dense(const NormalEquations& equations, const Case& c) {
  const int n = c.inner.size();
  BlockBandedMatrix matrix(c.outer.size(), n, c.outer.degree());
  equations.AddTo(matrix);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(matrix.size(), matrix.size());
  for (int row = 0; row < matrix.blocks(); ++row) {
    for (int below = 0; below <= std::min(row, matrix.bandwidth()); ++below) {
      dense.block((row - below) * n, row * n, n, n) = matrix.at(row, below).transpose();
      dense.block(row * n, (row - below) * n, n, n) = matrix.at(row, below);
    }
  }
  return dense;
}

TEST(CellOrderTest, PutsEveryPointIntoTheCellItsParametersLieIn) {
  ForRandomCases([](const Case& c) {
    const CellOrder order(c.outer, &c.inner, c.u, c.v);
    EXPECT_EQ(order.cell_count(), std::ssize(c.outer.Spans()) * std::ssize(c.inner.Spans()));
    std::vector<int> seen(c.u.size(), 0);
    Eigen::Index next = 0;
    for (const CellOrder::Cell& cell : order.cells()) {
      EXPECT_EQ(cell.begin, next) << "cells follow each other";
      EXPECT_GT(cell.end, cell.begin) << "only cells that hold points are listed";
      for (Eigen::Index i = cell.begin; i < cell.end; ++i) {
        const Eigen::Index k = order.points()[i];
        ++seen[k];
        EXPECT_EQ(c.outer.Span(c.u[k]), cell.outer_span);
        EXPECT_EQ(c.inner.Span(c.v[k]), cell.inner_span);
        if (i > cell.begin) {
          EXPECT_GT(k, order.points()[i - 1]);
        }
      }
      next = cell.end;
    }
    EXPECT_EQ(next, c.u.size());
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), c.u.size());
  });
}

TEST(NormalEquationsTest, AreTheDenseSumsOverThePoints) {
  ForRandomCases([](const Case& c) {
    const NormalEquations equations = Equations(c);
    const Eigen::MatrixXd design = Design(c);
    const Eigen::VectorXd w = Weights(c);
    const Eigen::MatrixXd matrix = design.transpose() * w.asDiagonal() * design;
    const Eigen::MatrixXd rhs = design.transpose() * w.asDiagonal() * c.values.transpose();
    const double size = kRounding * std::max(1.0, w.sum());
    EXPECT_LE((Dense(equations, c) - matrix).cwiseAbs().maxCoeff(), size);
    ASSERT_EQ(equations.rhs().rows(), rhs.rows());
    ASSERT_EQ(equations.rhs().cols(), rhs.cols());
    EXPECT_LE((equations.rhs() - rhs).cwiseAbs().maxCoeff(), size);
    EXPECT_NEAR(equations.trace(), matrix.trace(), size);
    EXPECT_NEAR(equations.squares(), w.dot(c.values.colwise().squaredNorm().transpose()), size);
  });
}

TEST(NormalEquationsTest, AddToWhatAMatrixHolds) {
  RandomSplines random(1);
  const Case c = RandomCase(random);
  const NormalEquations equations = Equations(c);
  BlockBandedMatrix matrix(c.outer.size(), c.inner.size(), c.outer.degree());
  matrix.AddToDiagonal(2);
  equations.AddTo(matrix);
  EXPECT_NEAR(matrix.Trace(), equations.trace() + 2.0 * matrix.size(), kRounding * matrix.Trace());
}

TEST(NormalEquationsTest, DoNotSeePointsOfWeightZero) {
  ForRandomCases([](const Case& given) {
    Case c = given, without = given;
    c.weights = Weights(c);
    without.weights = c.weights;
    for (Eigen::Index k = 0; k < c.u.size(); k += 2) {
      c.weights[k] = without.weights[k] = 0;
      without.values.col(k).setConstant(1e300);
    }
    const NormalEquations a = Equations(c), b = Equations(without);
    EXPECT_EQ(a.rhs(), b.rhs());
    EXPECT_EQ(a.squares(), b.squares());
    EXPECT_EQ(a.trace(), b.trace());
  });
}

TEST(NormalEquationsTest, TakeNoWeightsForOnes) {
  ForRandomCases([](const Case& given) {
    Case none = given, ones = given;
    none.weights.resize(0);
    ones.weights.setOnes(given.u.size());
    EXPECT_EQ(Equations(none).rhs(), Equations(ones).rhs());
    EXPECT_EQ(Dense(Equations(none), none), Dense(Equations(ones), ones));
  });
}

TEST(NormalEquationsTest, AreTheSameBitsForEveryNumberOfThreads) {
  ForRandomCases([](const Case& c) {
    const NormalEquations one = Equations(c, 1);
    for (const int threads : {2, 3}) {
      const NormalEquations more = Equations(c, threads);
      EXPECT_EQ(more.rhs(), one.rhs());
      EXPECT_EQ(more.squares(), one.squares());
      EXPECT_EQ(more.trace(), one.trace());
      EXPECT_EQ(Dense(more, c), Dense(one, c));
    }
  });
}

TEST(NormalEquationsTest, OfNoPointsAreZero) {
  RandomSplines random(2);
  const Case c{random.Basis(2), random.Basis(3), {}, {}, Eigen::MatrixXd(3, 0), {}};
  const NormalEquations equations = Equations(c);
  EXPECT_EQ(equations.rhs().cols(), 3);
  EXPECT_TRUE(equations.rhs().isZero(0));
  EXPECT_EQ(equations.trace(), 0);
  EXPECT_TRUE(Dense(equations, c).isZero(0));
}

}  // namespace
}  // namespace batten
