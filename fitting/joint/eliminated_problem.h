// SPDX-License-Identifier: MIT
// The joint problem with foot points eliminated: one quadratic form in the unknowns per knot cell.
// Used by the joint stage only.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "fitting/foot_points/joint_foot_points.h"
#include "fitting/joint/joint_options.h"
#include "fitting/knots/knot_gaps.h"
#include "fitting/least_squares/residual_noise.h"

namespace batten::internal {

// The unknowns of a changing shape, the foot points of all data on it, and, per knot cell, the
// quadratic form that remains of the data there. Unknowns are control points, logarithms of weights
// (what is positive stays so, and a common factor is a common summand) and logarithms of the gaps
// between knots (what is ordered stays so). A periodic direction has its first and last control
// points in common.
class EliminatedProblem {
 public:
  // Throws std::invalid_argument where the problem and the net do not go together.
  EliminatedProblem(const FittingProblem& problem,
                    const Eigen::MatrixXd& control_points,
                    const Eigen::VectorXd& weights,
                    const JointOptions& options,
                    ThreadPool& pool);

  // The unknowns; the optimiser writes there. A block is a control point that is no copy.
  int dimension() const { return shape_.dimension(); }
  int blocks() const { return static_cast<int>(net_.cols()); }
  int BlockOf(int control_point) const { return block_of_[static_cast<size_t>(control_point)]; }
  double* point(int block) { return net_.col(block).data(); }
  const Eigen::MatrixXd& net() const { return net_; }  // a column a block
  void SetNet(const Eigen::MatrixXd& net) { net_ = net; }
  double* log_weight(int block) { return &log_weights_[block]; }
  int directions() const { return static_cast<int>(directions_.size()); }
  bool free_weights() const { return options_.free_weights; }
  bool free_knots(int direction) const { return directions_[direction].free; }
  double* log_gaps(int direction) { return directions_[direction].log_gaps.data(); }
  int gaps(int direction) const {
    return directions_[direction].free ? directions_[direction].gaps.groups() + 1 : 0;
  }

  // d knots / d log gaps at the accepted state, a row for each knot of the direction's basis.
  Eigen::MatrixXd KnotChain(int direction) const;

  int cells() const { return static_cast<int>(cells_.size()); }
  int functions() const { return functions_; }      // control points of a cell
  std::vector<int> BlocksOf(int cell) const;        // their blocks
  int columns() const;                              // unknowns a cell depends on
  int rows() const { return local_columns() + 1; }  // residuals of a cell

  // Projects every point onto the shape of the present unknowns and sorts them into cells. False
  // where the step there is refused: something is not finite, too far from the accepted state to be
  // trusted, or a normal has turned over.
  bool Project();

  // Projects without checking the distance from the accepted state.
  bool Return();

  // Accepts the present state as the start of later steps: foot points, damping, Jacobians. The
  // latter on the pool, so that nothing depends on its number of threads.
  void Accept();

  // Accepts the present state without Jacobians, which only Ceres needs. `damping` is ignored.
  void AcceptState();

  // Whether only control points are free: then the sums of the cells determine the cost.
  bool only_points() const { return !options_.free_weights && local_knots() == 0; }

  // The sums of one cell at the accepted state, as AddCellProducts (joint_kernels.h) leaves them,
  // with M the part of the unit matrix that moving the foot point cannot undo, and one, both times
  // the point's weight and over the square of Σ N w; where all weights are equal that is 1.
  struct Sums {
    int span_u, span_v;
    const double* pairs;
    const double* pulls;
    const Eigen::MatrixXd& fairness;  // in the functions of the cell; may be empty
    double regularized;               // what counts of it
  };
  Sums SumsOf(int cell) const;
  double function_weight(int control_point) const {
    return rational_ ? shape_.weights[control_point] : 1.0;
  }

  // Half the sum of squares of Evaluate's residuals at a damping, without derivatives.
  double Cost(double of_damping) const;

  // Residuals (rows()) of a cell whose squares add up to twice its cost; with their Jacobian
  // (rows() × columns(), row major) at the accepted state. Columns: control points, weights, gaps
  // of u, gaps of v, as far as they are free.
  void Evaluate(int cell, double* residual, double* jacobian) const;

  // Σ d² of the last projection, without weights.
  double SquaredDistances() const { return foot_points_.SquaredDistances(); }

  // Σ w 2ρ(d) there.
  double RobustSquares() const;

  // Σ w ρ'(d)/d d² there, and the sum that noise alone would leave (see ResidualNoise): where the
  // first is not more, the rest of the residuals is noise.
  struct Explained {
    double squares, by_noise;
  };
  Explained NoiseShare() const;
  const TensorShape& shape() const { return shape_; }
  const Eigen::Matrix2Xd& feet() const { return foot_points_.parameters; }
  const Eigen::VectorXd& log_weights() const { return log_weights_; }

  double damping = 1e-2;  // of the steps from the next accepted state on

 private:
  struct Cell {
    int span_u, span_v;
    Eigen::MatrixXd fairness;         // form in the functions of the cell
    Eigen::MatrixXd proximal;         // how far the shape moves, at the accepted state
    double regularized = 1;           // what of the fairness counts
    Eigen::Index begin = 0, end = 0;  // its points in order_
  };
  struct Workspace;
  Workspace WorkspaceOf(const Cell& cell) const;

  int local_columns() const;  // with the knots the cell depends on instead of the gaps
  int local_knots() const;    // their number
  void MakeBlocks();
  void MakeCells();
  void MakeFairness();
  bool UpdateShape();
  bool NearAccepted() const;
  bool ProjectPoints();
  double Weight(Eigen::Index k) const;
  double Distance(Eigen::Index k) const { return foot_points_.difference.col(k).norm(); }
  void FillRow(const Workspace& work,
               const Eigen::VectorXd& direction,
               double scale,
               double* row) const;
  void Prepare(const Cell& cell, Eigen::Index k, Workspace& work) const;
  Eigen::MatrixXd CellForm(const Cell& cell) const;
  void Linearise();
  void Rows(const Cell& cell, double* residual, double* jacobian) const;
  void AddPoints(const Cell& cell, bool in_all_directions, Eigen::MatrixXd& form) const;
  double PointsCost(const Cell& cell) const;
  Eigen::MatrixXd ProximalForm(const Cell& cell) const;
  size_t pairs_length() const;
  size_t sums_length() const;
  void SumPoints();
  void SumCell(const Cell& cell, double* sums) const;
  template <typename Use>
  void ForPairs(const Cell& cell, const double* pairs, const Use& use) const;
  void AddSums(const Cell& cell, Eigen::MatrixXd& form) const;
  Eigen::MatrixXd ProximalOfSums(const Cell& cell, const double* pairs) const;
  Eigen::VectorXd Displacement(const Cell& cell) const;
  double CellCost(const Cell& cell, double of_damping) const;
  double FreePrior() const;
  double Prior(int block) const;

  const JointOptions& options_;
  ThreadPool& pool_;
  std::shared_ptr<const FittingData> data_;
  FootProjector projector_;
  TensorShape shape_, accepted_;
  // The knots of u and, for surfaces, of v.
  struct Direction {
    bool free;
    KnotGaps gaps;
    Eigen::VectorXd log_gaps;   // the unknowns
    std::vector<int> group_of;  // of every knot
    Eigen::MatrixXd chain;      // d knots (groups) / d log gaps, at the accepted state
  };
  std::vector<Direction> directions_;
  std::vector<int> block_of_;
  Eigen::MatrixXd net_;
  Eigen::VectorXd log_weights_, accepted_log_weights_, cells_of_block_;
  int functions_;
  FairnessEnergy energy_;
  double fairness_unit_ = 0, start_squares_ = -1, prior_ = 0, used_damping_ = 0;
  std::vector<Cell> cells_;
  std::vector<Eigen::Index> order_;  // points sorted by cell
  std::vector<double> linear_;       // a cell: residuals, then the Jacobian
  std::vector<double> sums_;         // a cell: of pairs, then of pulls; where only points are free
  bool rational_ = false;            // weights differ
  FootPointSet foot_points_;
  Eigen::Matrix2Xd accepted_foot_points_;
  ResidualNoise residual_noise_;
  std::optional<Facing> facing_;  // at the accepted state
  Facing new_facing_;
};

}  // namespace batten::internal
