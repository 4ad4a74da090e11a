// SPDX-License-Identifier: MIT
// Cross-validation by blocks of neighbouring points, for noise that neighbours share.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/fitting_problem.h"

namespace batten::internal {

// Mean spacing of the points in the parameter domain: √(area / m) over the part of the domain that
// holds points. O(m).
double ParameterSpacing(const FittingProblem& problem);

// Block cross-validation: measures how well bases predict blocks of points that were left out. The
// domain is cut into square blocks; every fifth is left out at a time, none of them neighbours, so
// that no left-out point has a near neighbour in its own fit but at a block's rim. Noise correlated
// over less than a block is then predicted by no basis. Fairness and weights are the problem's.
// [Roberts et al. 2017, Ecography 40]
class BlockValidation {
 public:
  // Blocks of about `width`, in the units of the parameters. Throws std::invalid_argument unless
  // the problem is a surface's and the width positive. O(m).
  BlockValidation(const FittingProblem& problem, double width);

  // Weighted sum of squared errors at the left-out points of every block that holds points, each
  // from the fit without it; bases on the problem's domain. Infinite where such a fit does not
  // exist. Five solutions for one assembly: O(m + n · min(n_u, n_v)²).
  Eigen::VectorXd Errors(const SplineBasis& basis_u,
                         const SplineBasis& basis_v,
                         ThreadPool& pool) const;

  int blocks() const { return blocks_; }                          // that hold points
  const std::vector<int>& block_of() const { return block_of_; }  // every point is in

 private:
  struct Fold {
    Eigen::VectorXd u, v, weights;  // no weights: ones
    Eigen::MatrixXd values;
    std::vector<int> block;  // of every point
  };
  std::vector<Fold> folds_;
  std::vector<int> block_of_;
  int blocks_ = 0;
  double smoothing_;
  Poles poles_;
};

}  // namespace batten::internal
