// SPDX-License-Identifier: MIT
#include "fitting/joint/joint_ceres.h"

#include <algorithm>
#include <cmath>
#include <utility>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#include <ceres/ceres.h>
#pragma GCC diagnostic pop

#include "fitting/joint/iteration_monitor.h"

namespace batten::internal {
namespace {

constexpr int kDenseUnknowns = 250;  // up to here a dense factorisation is faster
constexpr double kRadius = 1e8;
constexpr double kFirstDamping = 1e-2;
constexpr int kRenewal = 20;
constexpr double kValleyRadius = 1e4;

// Projects and sorts the points whenever Ceres looks at a new place.
class Projector : public ceres::EvaluationCallback {
 public:
  explicit Projector(EliminatedProblem& cells) : cells_(cells) {}
  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override {
    // Ceres asks for Jacobians where it starts, which is no step to be refused, and where it has
    // accepted one.
    if (new_evaluation_point) valid_ = evaluate_jacobians ? cells_.Return() : cells_.Project();
    if (evaluate_jacobians && valid_) cells_.Accept();
  }
  bool valid() const { return valid_; }

 private:
  EliminatedProblem& cells_;
  bool valid_ = true;
};

// The residuals of one knot cell.
class CellCost : public ceres::CostFunction {
 public:
  // `idle`: for a cell of which everything is fixed, an unknown that nothing depends on. Ceres
  // leaves out blocks without a free unknown, but points may move into the cell and out of it.
  CellCost(const EliminatedProblem& cells, const Projector& projector, int cell, double* idle)
      : cells_(cells), projector_(projector), cell_(cell), idle_(idle) {
    set_num_residuals(cells.rows());
    std::vector<int>& sizes = *mutable_parameter_block_sizes();
    sizes.assign(static_cast<size_t>(cells.functions()), cells.dimension());
    if (cells.free_weights()) sizes.insert(sizes.end(), static_cast<size_t>(cells.functions()), 1);
    for (int d = 0; d < cells.directions(); ++d) {
      if (cells.free_knots(d)) sizes.push_back(cells.gaps(d));
    }
    if (idle_) sizes.push_back(1);
  }

  std::vector<double*> Blocks(EliminatedProblem& cells) const {
    std::vector<double*> blocks;
    const std::vector<int> own = cells.BlocksOf(cell_);
    for (const int k : own) blocks.push_back(cells.point(k));
    if (cells.free_weights()) {
      for (const int k : own) blocks.push_back(cells.log_weight(k));
    }
    for (int d = 0; d < cells.directions(); ++d) {
      if (cells.free_knots(d)) blocks.push_back(cells.log_gaps(d));
    }
    if (idle_) blocks.push_back(idle_);
    return blocks;
  }

  bool Evaluate(const double* const*, double* residuals, double** jacobians) const override {
    if (!projector_.valid()) return false;  // the step is refused
    if (jacobians == nullptr) {
      cells_.Evaluate(cell_, residuals, nullptr);
      return true;
    }
    const int rows = cells_.rows(), columns = cells_.columns();
    std::vector<double> whole(static_cast<size_t>(rows) * columns);
    cells_.Evaluate(cell_, residuals, whole.data());
    const std::vector<int>& sizes = parameter_block_sizes();
    const size_t own = sizes.size() - (idle_ ? 1 : 0);
    if (idle_ && jacobians[own] != nullptr) std::fill_n(jacobians[own], rows, 0.0);
    int column = 0;
    for (size_t block = 0; block < own; column += sizes[block++]) {
      if (jacobians[block] == nullptr) continue;
      for (int r = 0; r < rows; ++r) {
        std::copy_n(whole.data() + static_cast<size_t>(r) * columns + column,
                    sizes[block],
                    jacobians[block] + static_cast<size_t>(r) * sizes[block]);
      }
    }
    return true;
  }

 private:
  const EliminatedProblem& cells_;
  const Projector& projector_;
  int cell_;
  double* idle_;
};

// Watches the noise, the user, and how well the damping suits.
class Watcher : public ceres::IterationCallback {
 public:
  Watcher(EliminatedProblem& cells, const JointOptions& options, JointResult& result)
      : cells_(cells), options_(options), result_(result), watch_(cells, options, result) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    const bool start = summary.iteration == 0;
    const int iterations = result_.iterations + summary.iteration;
    if (watch_.Cancelled(iterations)) return ceres::SOLVER_ABORT;
    if (options_.free_weights) return Fade(summary);
    if (!summary.step_is_successful) {
      // Tried again with more of the damping of the cells, for which Ceres has to look at them
      // anew.
      ++refusals_;
      Damp(std::pow(2.0, refusals_));
      return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    }
    if (!start) {
      refusals_ = 0;
      Damp(std::max(0.2, 1 - std::pow(2 * summary.relative_decrease - 1, 3)));
    }
    if (!start || result_.rounds.empty()) Record(summary);
    return watch_.Settled() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

  // Whether the last step was refused and another is worth trying.
  bool tries_again() const {
    return refusals_ > 0 && refusals_ <= kMostRefusals && !result_.cancelled;
  }

 private:
  // With free weights many shapes are the same set of points, the Jacobian becomes singular where
  // they are met, and the way there is a curved valley: the damping fades with the squares of the
  // residuals [Yamashita & Fukushima 2001], and is renewed now and then; steps may go uphill for a
  // while; refused ones are left to Ceres.
  ceres::CallbackReturnType Fade(const ceres::IterationSummary& summary) {
    if (!summary.step_is_successful) return ceres::SOLVER_CONTINUE;
    if (summary.iteration > 0 || result_.rounds.empty()) Record(summary);
    const double start = result_.rms_before > 0 ? result_.rms_before : 1.0;
    const double ratio = result_.rounds.back().rms / start;
    cells_.damping =
        LimitedDamping(kFirstDamping * std::pow(0.5, summary.iteration % kRenewal) * ratio * ratio);
    return watch_.Settled() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

  void Damp(double factor) { cells_.damping = LimitedDamping(cells_.damping * factor); }

  void Record(const ceres::IterationSummary& summary) {
    watch_.Record(summary.cost, summary.iteration_time_in_seconds);
  }

  EliminatedProblem& cells_;
  const JointOptions& options_;
  JointResult& result_;
  IterationMonitor watch_;
  int refusals_ = 0;
};

// Every cell's block, every term's, and what is fixed.
void Assemble(ceres::Problem& problem,
              EliminatedProblem& cells,
              const Projector& projector,
              const std::vector<bool>& fixed,
              JointTerms terms,
              double& idle) {
  bool knots = false;
  for (int d = 0; d < cells.directions(); ++d) knots = knots || cells.free_knots(d);
  for (int cell = 0; cell < cells.cells(); ++cell) {
    const std::vector<int> own = cells.BlocksOf(cell);
    const bool held = !knots && std::all_of(own.begin(), own.end(), [&](int block) {
      return fixed[static_cast<size_t>(block)];
    });
    auto cost = std::make_unique<CellCost>(cells, projector, cell, held ? &idle : nullptr);
    const std::vector<double*> blocks = cost->Blocks(cells);
    problem.AddResidualBlock(cost.release(), nullptr, blocks);
  }
  for (std::unique_ptr<TermCost>& term : terms) {
    const std::vector<double*> blocks = term->Blocks(cells);
    problem.AddResidualBlock(term.release(), nullptr, blocks);
  }
  for (int block = 0; block < cells.blocks(); ++block) {
    if (!fixed[static_cast<size_t>(block)]) continue;
    problem.SetParameterBlockConstant(cells.point(block));
    if (cells.free_weights()) problem.SetParameterBlockConstant(cells.log_weight(block));
  }
}

ceres::Solver::Options SolverOptions(const JointOptions& options, const EliminatedProblem& cells) {
  ceres::Solver::Options solver;
  const int unknowns = cells.blocks() * (cells.dimension() + (cells.free_weights() ? 1 : 0)) +
                       cells.gaps(0) + (cells.directions() > 1 ? cells.gaps(1) : 0);
  solver.linear_solver_type =
      unknowns <= kDenseUnknowns ? ceres::DENSE_NORMAL_CHOLESKY : ceres::SPARSE_NORMAL_CHOLESKY;
  solver.num_threads = 1;  // cells are made ready on the pool; sums are the same on any
  // Damping is the cells' own; Ceres' keeps the factorisation from failing.
  solver.initial_trust_region_radius = solver.max_trust_region_radius = kRadius;
  if (options.free_weights) {
    solver.initial_trust_region_radius = kValleyRadius;
    solver.use_nonmonotonic_steps = true;
    solver.max_num_consecutive_invalid_steps = 30;
  }
  solver.function_tolerance = options.least_gain;
  solver.gradient_tolerance = 0;
  solver.parameter_tolerance = 1e-14;
  if (options.seconds > 0) solver.max_solver_time_in_seconds = options.seconds;
  solver.logging_type = ceres::SILENT;
  solver.update_state_every_iteration = true;
  return solver;
}

}  // namespace

void MinimiseByCeres(EliminatedProblem& cells,
                     const std::vector<bool>& fixed,
                     JointTerms terms,
                     const JointOptions& options,
                     JointResult& result) {
  Projector projector(cells);
  Watcher watcher(cells, options, result);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &projector;
  ceres::Problem problem(problem_options);
  double idle = 0;
  Assemble(problem, cells, projector, fixed, std::move(terms), idle);
  ceres::Solver::Options solver = SolverOptions(options, cells);
  solver.callbacks.push_back(&watcher);
  ceres::Solver::Summary summary;
  do {
    solver.max_num_iterations = options.max_iterations - result.iterations;
    ceres::Solve(solver, &problem, &summary);
    result.iterations += static_cast<int>(summary.iterations.size()) - 1;
  } while (summary.termination_type == ceres::USER_SUCCESS && watcher.tries_again() &&
           result.iterations < options.max_iterations);
  if (summary.termination_type == ceres::FAILURE && result.note.empty()) {
    result.note = "Ceres stopped: " + summary.message;
  }
}

}  // namespace batten::internal
