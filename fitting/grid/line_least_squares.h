// SPDX-License-Identifier: MIT
// Spline least squares of many right-hand sides at once along one direction of a grid.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <span>
#include <vector>

#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// The normal matrix of a basis at m ≥ n increasing parameters, and its factor: banded, of periodic
// bases dense. With `meet_ends` the first and last data are met exactly, as the ends of a clamped
// basis allow, and the rest is fitted to what they leave. [Piegl & Tiller 1997, §9.4.1, A9.6, A9.7]
class LineLeastSquares {
 public:
  // Throws std::invalid_argument where the parameters of an open basis don't determine the spline
  // (Schoenberg and Whitney's condition), or ends are to be met over a basis that is not clamped.
  // O(m·p²). Weights (empty: ones) are positive and multiply squares.
  LineLeastSquares(const SplineBasis& basis,
                   std::span<const double> parameters,
                   bool meet_ends,
                   std::span<const double> weights = {});

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
  void Factor();
  void SolveBanded(double* x, Eigen::Index width) const;
  void Solve(const double* data, Eigen::Index stride, Eigen::Index width, double* control) const;

  Eigen::Index size_, data_size_, distinct_;
  int degree_;
  bool meet_ends_, regular_ = true;
  std::vector<Eigen::Index> first_;  // function at each parameter
  std::vector<double> values_;       // p + 1 at each
  std::vector<double> weights_;
  std::vector<double> band_;  // of the factor L D Lᵀ: row i holds L_{i,i−p} … and 1/D_i
  Eigen::LDLT<Eigen::MatrixXd> ring_;
};

}  // namespace batten::internal
