// SPDX-License-Identifier: MIT
#include "fitting/least_squares/fitting_bases.h"

#include <algorithm>

#include "batten/geometry/knot_vectors.h"

namespace batten::internal {
namespace {

constexpr double kEndCellWidth = 1.6;

// The knots of a periodic basis' domain, both ends included.
std::vector<double> Breaks(const SplineBasis& basis) {
  return {basis.knots().begin() + basis.degree(), basis.knots().begin() + basis.size() + 1};
}

SplineBasis OfKnots(const SplineBasis& like, std::vector<double> knots) {
  return like.periodic() ? PeriodicKnots(like.degree(), knots)
                         : SplineBasis(like.degree(), std::move(knots));
}

std::vector<double> OwnKnots(const SplineBasis& basis) {
  return basis.periodic() ? Breaks(basis) : basis.knots();
}

}  // namespace

SplineBasis FittingBasis(int degree, int cells, double lower, double upper) {
  std::vector<double> breaks{lower};
  const double end = cells >= 3 ? kEndCellWidth : 1;
  const double unit = (upper - lower) / (cells >= 2 ? cells - 2 + 2 * end : 1);
  for (int i = 1; i < cells; ++i) breaks.push_back(lower + unit * (end + i - 1));
  breaks.push_back(upper);
  return SplineBasis::Clamped(degree, breaks);
}

SplineBasis FittingBasisLike(const SplineBasis& like, int degree, int cells) {
  return like.periodic()
             ? PeriodicUniformKnots(degree, std::max(cells, degree + 1), like.lower(), like.upper())
             : FittingBasis(degree, cells, like.lower(), like.upper());
}

int LeastCells(const SplineBasis& like, int degree) { return like.periodic() ? degree + 1 : 1; }

FittingProblem OverCells(const FittingProblem& problem, int cells_u, int cells_v) {
  const SplineBasis &u = problem.basis_u(), &v = problem.basis_v();
  return problem.WithBases(FittingBasisLike(u, u.degree(), cells_u),
                           FittingBasisLike(v, v.degree(), cells_v));
}

int FreedomOfCells(const SplineBasis& like, int degree, int cells) {
  return like.periodic() ? std::max(cells, degree + 1) : cells + degree;
}

SplineBasis WithInnerKnots(const SplineBasis& basis, const std::vector<double>& more) {
  if (more.empty()) return basis;
  std::vector<double> knots = OwnKnots(basis);
  knots.insert(knots.end(), more.begin(), more.end());
  std::sort(knots.begin(), knots.end());
  return OfKnots(basis, std::move(knots));
}

SplineBasis WithoutInnerKnots(const SplineBasis& basis, const std::vector<double>& gone) {
  if (gone.empty()) return basis;
  std::vector<double> knots = OwnKnots(basis);
  std::erase_if(
      knots, [&](double knot) { return std::find(gone.begin(), gone.end(), knot) != gone.end(); });
  return OfKnots(basis, std::move(knots));
}

double WeightOf(const FittingProblem& problem) {
  const Eigen::VectorXd& weights = problem.data().weights;
  return weights.size() > 0 ? weights.sum() : static_cast<double>(problem.size());
}

double SquaresOf(const FittingProblem& problem,
                 const Eigen::MatrixXd& coefficients,
                 ThreadPool& pool) {
  const Eigen::VectorXd squares =
      (EvaluateAt(problem, coefficients, pool) - problem.data().values).colwise().squaredNorm();
  const Eigen::VectorXd& weights = problem.data().weights;
  return weights.size() > 0 ? weights.dot(squares) : squares.sum();
}

double PointCount(const FittingProblem& problem) {
  const Eigen::VectorXd& weights = problem.data().weights;
  return static_cast<double>(weights.size() > 0 ? (weights.array() > 0).count() : problem.size());
}

}  // namespace batten::internal
