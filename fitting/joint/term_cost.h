// SPDX-License-Identifier: MIT
// A user's residual term as Ceres wants it. Used by the joint stage only.
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

// Hands the term the values of the present shape, and turns its derivatives into those of the
// optimiser's unknowns: logarithms of weights and of gaps between knots, one block for all copies
// of a control point.
class TermCost : public ceres::CostFunction {
 public:
  // `unit`: of the cells' lengths, in the user's; the term sees the user's. Throws
  // std::invalid_argument where the term names what is not there.
  TermCost(std::shared_ptr<const ResidualTerm> term,
           const EliminatedProblem& cells,
           double unit = 1);

  // The unknowns it depends on, in the order of Evaluate's parameters.
  std::vector<double*> Blocks(EliminatedProblem& cells) const;

  // Whether some of them is free, of control points and weights those that are not `fixed`, block
  // by block. Of what is not, no step takes notice.
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
