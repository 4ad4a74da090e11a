// SPDX-License-Identifier: MIT
// The Gauss-Newton system of the joint stage where only control points are free. Used by the joint
// stage only.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fitting/joint/eliminated_problem.h"
#include "fitting/linear/block_banded_matrix.h"

namespace batten::internal {

// The quadratic model of the cost at the accepted state of the cells, with its damping: a block
// band of control net rows, all coordinates together, as distances along normals couple them.
class GaussNewtonSystem {
 public:
  // `fixed`: the blocks of the cells that stay.
  GaussNewtonSystem(const EliminatedProblem& cells, std::vector<bool> fixed, ThreadPool& pool);

  // Updates the gradient from the sums of the accepted state.
  void Refresh();

  // The greatest entry of the gradient.
  double steepness() const { return gradient_.cwiseAbs().maxCoeff(); }

  // The step (dimension × blocks of the cells) to the minimum of the model with so much damping,
  // and by how much that lowers the model. None where the matrix cannot be factored.
  // O(rows · bandwidth² · row³), `row` the unknowns of a row of the net.
  struct Step {
    Eigen::MatrixXd net;
    double promise;
  };
  std::optional<Step> Solve(double damping);

 private:
  // One function of a cell: the block row of its control point, the place inside it, its block, and
  // its weight.
  struct Function {
    int row, place, block;
    bool fixed;
    double weight;
  };
  std::vector<Function> FunctionsOf(const EliminatedProblem::Sums& sums) const;
  void Fill(double damping);
  void AddCell(int cell, int row, double damping);

  const EliminatedProblem& cells_;
  ThreadPool& pool_;
  std::vector<bool> fixed_;
  bool u_outside_;
  std::vector<int> row_of_, place_of_;  // of every control point
  BlockBandedMatrix matrix_;
  std::vector<std::vector<int>> cells_of_row_;
  Eigen::VectorXd gradient_;  // in the order of the matrix
};

}  // namespace batten::internal
