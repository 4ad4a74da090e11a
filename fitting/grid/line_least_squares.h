// SPDX-License-Identifier: MIT
// Spline least squares of many right-hand sides at once along one direction of a grid.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/linear/banded_lu.h"

namespace batten::internal {

// Numbers that are solved side by side: some rows of them stay in the cache.
inline constexpr Eigen::Index kSolvedTogether = 48;

// The normal matrix of a basis at m ≥ n increasing parameters, and its factors, banded. With
// `meet_ends` the first and last data are met exactly, as the ends of a clamped basis allow, and
// the rest is fitted to what they leave. [Piegl & Tiller 1997, §9.4.1, A9.6, A9.7]
class LineLeastSquares {
 public:
  // Throws std::invalid_argument where the parameters of an open basis don't determine the spline
  // (Schoenberg and Whitney's condition), or ends are to be met over a basis that is not clamped.
  // O(m·p²).
  LineLeastSquares(const SplineBasis& basis, std::span<const double> parameters, bool meet_ends);

  Eigen::Index size() const { return size_; }  // control points, repeated ones included
  bool regular() const { return regular_; }    // otherwise solutions are meaningless

  // Turns m lines of `width` numbers into n lines of control points. O(m·p·width).
  void SolveLines(const double* data, Eigen::Index width, double* control, ThreadPool& pool) const;

  // Does the same within each of `count` lines of m points of `dimension` numbers.
  void SolveWithin(const double* data,
                   Eigen::Index count,
                   int dimension,
                   double* control,
                   ThreadPool& pool) const;

  // Evaluates n lines of control points at the parameters: m lines.
  void EvaluateLines(const double* control, Eigen::Index width, double* values) const;

 private:
  // The row of the matrix of a function that acts at a parameter.
  int Row(size_t parameter, size_t function) const {
    return rows_[static_cast<size_t>(first_[parameter]) + function];
  }
  RightSides Solve(const double* data, Eigen::Index stride, Eigen::Index width) const;

  Eigen::Index size_, data_size_;
  int degree_;
  bool meet_ends_, regular_ = true;
  std::vector<Eigen::Index> first_;  // function at each parameter
  std::vector<double> values_;       // p + 1 at each
  std::vector<int> rows_;            // of the matrix, by control point
  BandedLu matrix_;                  // its factors
};

}  // namespace batten::internal
