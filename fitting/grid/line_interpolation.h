// SPDX-License-Identifier: MIT
// Spline interpolation of many right-hand sides at once along one direction of a grid.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Numbers that are solved side by side: some rows of them stay in the cache.
inline constexpr Eigen::Index kSolvedTogether = 48;

// The LU factors of the collocation matrix N_j(t_i) of an open basis at as many increasing
// parameters. Such a matrix is totally positive, so that elimination without interchanges is stable
// and rounding errors are as small as those of the best order. [de Boor & Pinkus 1977; Piegl &
// Tiller 1997, A9.1]
class LineInterpolation {
 public:
  // Throws std::invalid_argument where the Schoenberg–Whitney condition fails: each function needs
  // a parameter of its own inside its support. O(n·p²).
  LineInterpolation(const SplineBasis& basis, std::span<const double> parameters);

  // Replaces values at the parameters by control points, in place: along the lines, whose rows of
  // `width` numbers are solved side by side. O(n·p·width).
  void SolveLines(double* data, Eigen::Index width, ThreadPool& pool) const;

  // Does the same within each of `count` lines of n points of `dimension` numbers.
  void SolveWithin(double* data, Eigen::Index count, int dimension, ThreadPool& pool) const;

 private:
  void Solve(double* data, Eigen::Index stride, Eigen::Index width) const;

  Eigen::Index size_;
  int degree_;
  // Row i: the factors of p rows before it, the inverse pivot, and p entries above the diagonal.
  std::vector<double> band_;
};

}  // namespace batten::internal
