// SPDX-License-Identifier: MIT
#include "fitting/least_squares/normal_equations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "fitting/linear/coefficient_order.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::normal_equations_test {

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
  return NormalEquations(c.outer, &c.inner, RowsOf(c.u, c.v, c.values, c.weights), pool);
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

// Any degrees, knots open, unclamped or periodic, also far from zero; many points in one cell and
// none in the next; a curve where there is no inner basis.
struct AnyCase {
  SplineBasis outer;
  std::optional<SplineBasis> inner;
  Eigen::VectorXd u, v;
  Eigen::MatrixXd values;
  Eigen::VectorXd weights;

  const SplineBasis* inner_basis() const { return inner ? &*inner : nullptr; }
};

// The same functions over knots scaled and shifted.
SplineBasis Moved(const SplineBasis& basis, double unit, double origin) {
  std::vector<double> knots = basis.knots();
  for (double& knot : knots) knot = origin + unit * knot;
  return basis.periodic() ? SplineBasis::Periodic(basis.degree(), std::move(knots))
                          : SplineBasis(basis.degree(), std::move(knots));
}

SplineBasis AnyBasis(RandomSplines& random, int highest_degree) {
  const SplineBasis basis =
      random.Basis(random.Integer(1, highest_degree),
                   {.clamped = random.Coin(), .periodic = random.Integer(0, 2) == 0});
  const double unit = random.Logarithmic(1e-3, 1e6);
  return Moved(basis, unit, random.Coin() ? 5e6 * unit : 0.0);
}

AnyCase AnyRandomCase(RandomSplines& random, int highest_degree, int most_points) {
  SplineBasis outer = AnyBasis(random, highest_degree);
  std::optional<SplineBasis> inner;
  if (random.Integer(0, 3) > 0) inner = AnyBasis(random, highest_degree);
  const int m = random.Integer(1, most_points), d = random.Integer(1, 4);
  Eigen::VectorXd u(m), v(inner ? m : 0), weights(random.Coin() ? m : 0);
  Eigen::MatrixXd values(d, m);
  for (double& t : u) t = random.Parameter(outer);
  for (double& t : v) t = random.Parameter(*inner);
  for (double& z : values.reshaped()) z = random.Real(-1, 1);
  for (double& w : weights) w = random.Integer(0, 3) == 0 ? 0 : random.Logarithmic(1e-6, 1e6);
  return {std::move(outer),
          std::move(inner),
          std::move(u),
          std::move(v),
          std::move(values),
          std::move(weights)};
}

NormalEquations Equations(const AnyCase& c, int threads = 1) {
  ThreadPool pool(threads);
  return NormalEquations(c.outer, c.inner_basis(), RowsOf(c.u, c.v, c.values, c.weights), pool);
}

// Whole, in the order of the solver's rows.
Eigen::MatrixXd Dense(const NormalEquations& equations, const AnyCase& c) {
  BlockBandedMatrix matrix = EmptyMatrix(c.outer, c.inner_basis());
  equations.AddTo(matrix);
  const int n = matrix.block_size();
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(matrix.size(), matrix.size());
  for (int row = 0; row < matrix.blocks(); ++row) {
    for (int below = 0; below <= std::min(row, matrix.bandwidth()); ++below) {
      dense.block((row - below) * n, row * n, n, n) = matrix.at(row, below).transpose();
      dense.block(row * n, (row - below) * n, n, n) = matrix.at(row, below);
    }
  }
  return dense;
}

// Row k: every different tensor-product function at point k, columns as the solver's rows.
Eigen::MatrixXd Design(const AnyCase& c) {
  const std::vector<int> outer_rows = CoefficientOrder(c.outer).Rows(c.outer),
                         inner_rows = DistinctIndices(c.inner_basis());
  const int columns = c.inner ? DistinctCount(*c.inner) : 1;
  const int p = c.outer.degree(), q = c.inner ? c.inner->degree() : 0;
  Eigen::MatrixXd design =
      Eigen::MatrixXd::Zero(c.u.size(), Eigen::Index{DistinctCount(c.outer)} * columns);
  std::vector<double> No(p + 1), Ni(q + 1, 1.0);
  for (Eigen::Index k = 0; k < c.u.size(); ++k) {
    const int so = c.outer.Span(c.u[k]), si = c.inner ? c.inner->Span(c.v[k]) : 0;
    c.outer.Values(so, c.u[k], No.data());
    if (c.inner) c.inner->Values(si, c.v[k], Ni.data());
    for (int r = 0; r <= p; ++r) {
      for (int s = 0; s <= q; ++s)
        design(k, outer_rows[so - p + r] * columns + inner_rows[si - q + s]) += No[r] * Ni[s];
    }
  }
  return design;
}

// All terms of an entry of the matrix are positive: each entry is right to rounding of itself, and
// each of the right-hand side to rounding of the sum of its terms' sizes.
void ExpectPlainSums(const AnyCase& c) {
  const NormalEquations equations = Equations(c);
  const Eigen::MatrixXd design = Design(c);
  const Eigen::VectorXd w =
      c.weights.size() > 0 ? c.weights : Eigen::VectorXd(Eigen::VectorXd::Ones(c.u.size()));
  const Eigen::MatrixXd matrix = design.transpose() * w.asDiagonal() * design;
  const Eigen::MatrixXd sizes =
      design.transpose() * w.asDiagonal() * c.values.cwiseAbs().transpose();
  const Eigen::MatrixXd rhs = design.transpose() * w.asDiagonal() * c.values.transpose();
  const Eigen::MatrixXd dense = Dense(equations, c);
  EXPECT_LE(((dense - matrix).cwiseAbs() - kRounding * matrix).maxCoeff(), 0);
  EXPECT_LE(((equations.rhs() - rhs).cwiseAbs() - kRounding * sizes).maxCoeff(), 0);
  const double squares = w.dot(c.values.colwise().squaredNorm().transpose());
  EXPECT_NEAR(equations.squares(), squares, kRounding * squares);
}

TEST(CellOrderTest, PutsEveryPointIntoTheCellItsParametersLieIn) {
  ForRandomCases([](const Case& c) {
    const CellOrder order(c.outer, &c.inner, c.u, c.v);
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

TEST(NormalEquationsTest, AreThePlainSumsEntryByEntryOfAnyDegreeAndKnots) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    ExpectPlainSums(AnyRandomCase(random, seed % 6 == 0 ? 9 : 5, 900));
    if (HasFailure()) return;
  }
}

TEST(NormalEquationsTest, KeepTheirDigitsAtTheHighestDegree) {
  for (unsigned seed = 0; seed < 2; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    AnyCase c = AnyRandomCase(random, 1, 60);
    c.outer = SplineBasis::Uniform(kMaxDegree, kMaxDegree + 3, c.outer.lower(), c.outer.upper());
    ExpectPlainSums(c);
  }
}

TEST(NormalEquationsTest, AddUpOverPartsOfManyPointsWithTheSameBitsForEveryNumberOfThreads) {
  // More points than are dealt out at a time, in the order of places and at random.
  for (const bool sorted : {false, true}) {
    RandomSplines random(3);
    AnyCase c = AnyRandomCase(random, 3, 1);
    const Eigen::Index m = 300000, part = 110000;
    c.inner = AnyBasis(random, 3);
    c.u.resize(m);
    c.v.resize(m);
    c.values.resize(2, m);
    c.weights.resize(0);
    for (double& t : c.u) t = random.Real(c.outer.lower(), c.outer.upper());
    for (double& t : c.v) t = random.Real(c.inner->lower(), c.inner->upper());
    for (double& z : c.values.reshaped()) z = random.Real(-1, 1);
    if (sorted) std::sort(c.u.begin(), c.u.end());
    AnyCase one = c, two = c;
    one.u = c.u.head(part);
    one.v = c.v.head(part);
    one.values = c.values.leftCols(part);
    two.u = c.u.tail(m - part);
    two.v = c.v.tail(m - part);
    two.values = c.values.rightCols(m - part);
    const NormalEquations all = Equations(c);
    const Eigen::MatrixXd whole = Dense(all, c),
                          sum = Dense(Equations(one), c) + Dense(Equations(two), c);
    EXPECT_LE(((whole - sum).cwiseAbs() - kRounding * sum).maxCoeff(), 0);
    for (const int threads : {2, 3}) {
      const NormalEquations more = Equations(c, threads);
      EXPECT_EQ(more.rhs(), all.rhs());
      EXPECT_EQ(more.squares(), all.squares());
      EXPECT_EQ(more.trace(), all.trace());
      EXPECT_EQ(Dense(more, c), whole);
    }
  }
}

TEST(NormalEquationsTest, RefuseParametersThatAreNoNumbers) {
  RandomSplines random(4);
  for (const int threads : {1, 2}) {
    AnyCase c = AnyRandomCase(random, 3, 50);
    c.u[0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(Equations(c, threads), std::invalid_argument);
    EXPECT_THROW(CellOrder(c.outer, c.inner_basis(), c.u, c.v), std::invalid_argument);
  }
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

}  // namespace batten::internal::normal_equations_test
