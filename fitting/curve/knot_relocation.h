// SPDX-License-Identifier: MIT
// Relocation of a curve's knots by least squares at fixed parameters.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "fitting/curve/span_layout.h"

namespace batten::internal {

// Evaluates the sum of squares of many span layouts on the same data at low cost: the data are
// replaced by means of neighbours, some ten to a span, which loses little where spans are much
// wider.
class LayoutTrials {
 public:
  // The problem's data at its parameters. `spans`: about as many as the layouts will have.
  LayoutTrials(const FittingProblem& problem, int spans);

  // Σ w |C − z|² over the means, up to a constant that all layouts share; infinite where the data
  // do not determine the curve.
  double Squares(const SpanLayout& layout) const;

  // The contributions of each span's means to the normal matrix and the right-hand sides, one
  // column a span: a layout that differs by one break has the other columns in common.
  Eigen::MatrixXd Sums(const SplineBasis& basis) const;
  void SumSpan(const SplineBasis& basis, int span, Eigen::Ref<Eigen::VectorXd> sums) const;
  double Squares(const SplineBasis& basis, const Eigen::MatrixXd& sums) const;

 private:
  std::vector<double> parameters_;  // increasing
  Eigen::MatrixXd values_;          // d × m
  std::vector<double> weights_;
  double total_ = 0;  // Σ w |z|²
};

// Moves each inner break in turn by a share of the span beside it, as long as the squares fall, in
// sweeps of smaller and smaller shares. Corners and ends stay, no span gets narrower than 0.7 of
// what it was. The squares never rise.
SpanLayout RelocateKnots(const LayoutTrials& trials, SpanLayout layout);

}  // namespace batten::internal
