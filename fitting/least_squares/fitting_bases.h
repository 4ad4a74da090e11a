// SPDX-License-Identifier: MIT
// Spline bases with a given number of knot cells on a domain, open or periodic.
#pragma once

#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// A clamped basis of `cells` spans, equal but for the first and last, which are 1.6 times as wide
// where there are three or more: at an edge a cell has data on one side only.
SplineBasis FittingBasis(int degree, int cells, double lower, double upper);

// FittingBasis on the domain of the basis `like`; for a periodic one, the periodic basis of equal
// spans, at least LeastCells of them.
SplineBasis FittingBasisLike(const SplineBasis& like, int degree, int cells);

// The least number of cells: periodic functions would overlap themselves over fewer than degree +
// 1.
int LeastCells(const SplineBasis& like, int degree);

// The problem over so many cells of its domain (FittingBasisLike), its degrees kept.
FittingProblem OverCells(const FittingProblem& problem, int cells_u, int cells_v);

// The number of distinct coefficients of a basis like this one over so many cells.
int FreedomOfCells(const SplineBasis& like, int degree, int cells);

// The basis with simple knots added inside its domain, or without some of its simple inner knots;
// a periodic one stays periodic, its seam where it was.
SplineBasis WithInnerKnots(const SplineBasis& basis, const std::vector<double>& more);
SplineBasis WithoutInnerKnots(const SplineBasis& basis, const std::vector<double>& gone);

// The weight of a point, of all, and the number of points whose weight is not zero.
inline double WeightOf(const FittingData& data, Eigen::Index k) {
  return data.weights.size() > 0 ? data.weights[k] : 1;
}
double WeightOf(const FittingProblem& problem);
double PointCount(const FittingProblem& problem);

// Σ w |S(u, v) − z|²
double SquaresOf(const FittingProblem& problem,
                 const Eigen::MatrixXd& coefficients,
                 ThreadPool& pool);

}  // namespace batten::internal
