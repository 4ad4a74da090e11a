// SPDX-License-Identifier: MIT
// A user's residual term as a Ceres cost function. Used by the joint stage only.
#pragma once

#include <memory>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#include <ceres/cost_function.h>
#pragma GCC diagnostic pop

#include "batten/fitting/residual_term.h"
#include "fitting/joint/eliminated_problem.h"

namespace batten::internal {

// Evaluates the term at the present shape and turns its derivatives into those of the optimiser's
// unknowns: logarithms of weights and of gaps between knots, one block for all copies of a control
// point.
class TermCost : public ceres::CostFunction {
 public:
  // `unit`: of the cells' lengths, in the user's; the term sees the user's. Throws
  // std::invalid_argument where the term names what is not there.
  TermCost(std::shared_ptr<const ResidualTerm> term,
           const EliminatedProblem& cells,
           double unit = 1);

  // The unknowns it depends on, in the order of Evaluate's parameters.
  std::vector<double*> Blocks(EliminatedProblem& cells) const;

  // Whether any of them is free: knots, or control points and weights that are not `fixed`, block
  // by block. Other terms do not affect the steps.
  bool SeesFree(const std::vector<bool>& fixed) const;

  bool Evaluate(const double* const*, double* residuals, double** jacobians) const override;

 private:
  std::vector<double> Values() const;

  std::shared_ptr<const ResidualTerm> term_;
  const EliminatedProblem& cells_;
  double unit_;
  std::vector<int> points_, weights_;              // of the term
  std::vector<int> point_blocks_, weight_blocks_;  // of the optimiser, each once
  bool knots_[2];                                  // free, and the term looks at them
};

}  // namespace batten::internal
