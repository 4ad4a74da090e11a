// SPDX-License-Identifier: MIT
#include "fitting/least_squares/coarser_moments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "batten/geometry/nurbs_curve.h"
#include "fitting/least_squares/fairness.h"
#include "fitting/least_squares/nested_bases.h"
#include "fitting/least_squares/normal_equations.h"
#include "fitting/linear/overlapping_boxes.h"
#include "geometry/evaluation/evaluation_table.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::coarser_moments_test {

// Simple knots at random, and some of them.
struct Nested {
  SplineBasis fine, coarse;
};
Nested RandomNested(RandomSplines& random) {
  const int degree = random.Integer(1, 5);
  SplineBasis fine = random.Basis(degree, {.most_spans = 9, .highest_multiplicity = 1});
  SplineBasis coarse = EveryKnot(fine, random.Integer(1, 4));
  return {std::move(fine), std::move(coarse)};
}

TEST(NestedBasesTest, InsertedKnotsLeaveTheSpline) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    const Nested bases = RandomNested(random);
    const auto insertion = KnotInsertion(bases.coarse, bases.fine);
    Eigen::Matrix3Xd net(3, bases.coarse.size());
    for (auto point : net.colwise()) point = random.Vector(1);
    const NurbsCurve<3> curve(bases.coarse, net),
        refined(bases.fine, Eigen::Matrix3Xd((insertion * net.transpose()).transpose()));
    for (int k = 0; k < 20; ++k) {
      const double u = random.Parameter(bases.fine);
      EXPECT_LT((curve.At(u) - refined.At(u)).norm(), kRounding);
    }
  }
}

struct Points {
  Eigen::VectorXd u, v, weights;
  Eigen::MatrixXd values;
};
Points RandomPoints(RandomSplines& random, const SplineBasis& outer, const SplineBasis& inner) {
  const int m = random.Integer(1, 200), d = random.Coin() ? 1 : 3;
  Points points{Eigen::VectorXd(m),
                Eigen::VectorXd(m),
                Eigen::VectorXd(random.Coin() ? m : 0),
                Eigen::MatrixXd(d, m)};
  for (double& t : points.u) t = random.Parameter(outer);
  for (double& t : points.v) t = random.Parameter(inner);
  for (double& z : points.values.reshaped()) z = random.Real(-1, 1);
  for (double& w : points.weights) w = random.Real(0.1, 5);
  return points;
}

CellMoments Moments(const SplineBasis& outer, const SplineBasis& inner, const Points& p) {
  ThreadPool pool(1);
  const AxisStorage in_outer(outer, 0), in_inner(inner, 0);
  return CellMoments(
      in_outer.table(), &in_inner.table(), RowsOf(p.u, p.v, p.values, p.weights), pool);
}

TEST(CoarserMomentsTest, AreThoseOfThePoints) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    const Nested outer = RandomNested(random), inner = RandomNested(random);
    const Points points = RandomPoints(random, outer.fine, inner.fine);
    CellMoments direct = Moments(outer.coarse, inner.coarse, points);
    ThreadPool pool(2);
    CellMoments found = CoarserMoments(Moments(outer.fine, inner.fine, points),
                                       outer.fine,
                                       inner.fine,
                                       outer.coarse,
                                       inner.coarse,
                                       pool);
    ASSERT_EQ(found.numbers().size(), direct.numbers().size());
    // Of points on a knot either cell may have the moments; sums over both are theirs.
    const auto whole = [&](const CellMoments& moments, const Points& p) {
      const NormalEquations equations(outer.coarse, &inner.coarse, moments, pool);
      Eigen::MatrixXd all = equations.band().Times(
          Eigen::MatrixXd::Identity(equations.band().size(), equations.band().size()), pool);
      all.conservativeResize(Eigen::NoChange, all.cols() + p.values.rows());
      all.rightCols(p.values.rows()) = equations.rhs();
      return all;
    };
    const Eigen::MatrixXd expected = whole(direct, points);
    EXPECT_LT((whole(found, points) - expected).cwiseAbs().maxCoeff(),
              kRounding * (1 + expected.cwiseAbs().maxCoeff()));
  }
}

TEST(CoarserMomentsTest, ErrorsOfCellsAreThoseOfTheirPoints) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    const SplineBasis outer = RandomNested(random).fine, inner = RandomNested(random).fine;
    const Points points = RandomPoints(random, outer, inner);
    const Eigen::Index n = Eigen::Index{outer.size()} * inner.size(), d = points.values.rows();
    const Eigen::MatrixXd net = Eigen::MatrixXd::Random(n, d);
    ThreadPool pool(2);
    const CellErrors errors = ErrorsOfCells(Moments(outer, inner, points), outer, inner, net, pool);
    double squares = 0, weights = 0;
    std::vector<double> of_outer(outer.degree() + 1), of_inner(inner.degree() + 1);
    for (Eigen::Index k = 0; k < points.u.size(); ++k) {
      const int i = outer.Span(points.u[k]), j = inner.Span(points.v[k]);
      outer.Values(i, points.u[k], of_outer.data());
      inner.Values(j, points.v[k], of_inner.data());
      Eigen::VectorXd off = -points.values.col(k);
      for (int r = 0; r <= outer.degree(); ++r) {
        for (int s = 0; s <= inner.degree(); ++s)
          off +=
              of_outer[r] * of_inner[s] *
              net.row((i - outer.degree() + r) * inner.size() + j - inner.degree() + s).transpose();
      }
      const double w = points.weights.size() > 0 ? points.weights[k] : 1;
      squares += w * off.squaredNorm();
      weights += w;
    }
    EXPECT_NEAR(errors.squares.sum(), squares, kRounding * (1 + squares));
    EXPECT_NEAR(errors.weights.sum(), weights, kRounding * weights);
  }
}

// The oracle is the band of the whole net, factored at once.
TEST(OverlappingBoxesTest, SolveTheWholeSystem) {
  constexpr int kSide = 160;  // control points: more than one box
  const SplineBasis basis = SplineBasis::Uniform(3, kSide, 0, 1);
  Points points{Eigen::VectorXd(3 * kSide * kSide),
                Eigen::VectorXd(3 * kSide * kSide),
                {},
                Eigen::MatrixXd(1, 3 * kSide * kSide)};
  RandomSplines random(1);
  for (Eigen::Index k = 0; k < points.u.size(); ++k) {
    // A quarter is empty: only fairness goes through it.
    do {
      points.u[k] = random.Real(0, 1);
      points.v[k] = random.Real(0, 1);
    } while (points.u[k] < 0.5 && points.v[k] < 0.5);
    points.values(0, k) = std::sin(20 * points.u[k]) * std::cos(17 * points.v[k]);
  }
  ThreadPool pool(2);
  const CellMoments moments = Moments(basis, basis, points);
  const NormalEquations equations(basis, &basis, moments, pool);
  const FairnessForm fairness(basis, &basis);
  const double lambda = 1e-4 * equations.trace() / fairness.Trace();
  TensorBand matrix = equations.band();
  fairness.AddTo(matrix, lambda);
  BlockBandedMatrix whole = matrix.Of({0, kSide, 0, kSide});
  BlockBandedMatrix assembled(kSide, kSide, 3);
  std::vector<int> rows(kSide);
  std::iota(rows.begin(), rows.end(), 0);
  matrix.AddTo(assembled, rows, rows);
  const Eigen::MatrixXd probe = Eigen::MatrixXd::Random(matrix.size(), 1);
  EXPECT_LT((whole.Times(probe) - assembled.Times(probe)).norm(),
            kRounding * assembled.Times(probe).norm());
  ASSERT_TRUE(whole.Factor(&pool));
  Eigen::MatrixXd expected = equations.rhs();
  whole.Solve(expected);

  const SplineBasis coarse = EveryKnot(basis, 4);
  const CellMoments of_coarse = CoarserMoments(moments, basis, basis, coarse, coarse, pool);
  TensorBand small = NormalEquations(coarse, &coarse, of_coarse, pool).band();
  FairnessForm(coarse, &coarse).AddTo(small, lambda);
  const auto insertion = KnotInsertion(coarse, basis);
  const Eigen::MatrixXd start = Eigen::MatrixXd::Zero(matrix.size(), 1);
  const BoxSolution found = SolveByBoxes(
      matrix,
      CoarseSystem{insertion, insertion, small.Of({0, coarse.size(), 0, coarse.size()})},
      equations.rhs(),
      start,
      pool);
  EXPECT_FALSE(found.singular);
  EXPECT_LT(found.residual, 1e-12);
  // In the norm that is minimised; in the empty quarter the factor itself has lost more digits.
  const auto energy = [&](const Eigen::MatrixXd& x) {
    return std::sqrt(x.cwiseProduct(matrix.Times(x, pool)).sum());
  };
  EXPECT_LT(energy(found.rows - expected), kIterated * energy(expected));
  constexpr int kSteps = 60;  // they do not grow with the net; without the coarse one they do
  EXPECT_LT(found.iterations, kSteps);
  RecordProperty("iterations", found.iterations);
  ThreadPool one(1);
  EXPECT_EQ(SolveByBoxes(matrix, std::nullopt, equations.rhs(), start, one).rows,
            SolveByBoxes(matrix, std::nullopt, equations.rhs(), start, pool).rows);
}

}  // namespace batten::internal::coarser_moments_test
