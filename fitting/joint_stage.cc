// SPDX-License-Identifier: MIT
#include "batten/fitting/joint_stage.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#include <ceres/ceres.h>
#pragma GCC diagnostic pop

#include "batten/fitting/joint_cells.h"

namespace batten {
namespace {

// Projects and sorts the points whenever Ceres looks at a new place.
class Projector : public ceres::EvaluationCallback {
 public:
  explicit Projector(JointCells& cells) : cells_(cells) {}
  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override {
    if (new_evaluation_point) valid_ = cells_.Project();
    // Ceres asks for Jacobians only where it starts and where it has accepted a step.
    if (evaluate_jacobians && valid_) cells_.Accept();
  }
  bool valid() const { return valid_; }

 private:
  JointCells& cells_;
  bool valid_ = true;
};

// The rows of one knot cell.
class CellCost : public ceres::CostFunction {
 public:
  CellCost(const JointCells& cells, const Projector& projector, int cell)
      : cells_(cells), projector_(projector), cell_(cell) {
    set_num_residuals(cells.rows());
    mutable_parameter_block_sizes()->assign(static_cast<size_t>(cells.functions()), 3);
  }

  bool Evaluate(const double* const*, double* residuals, double** jacobians) const override {
    if (!projector_.valid()) return false;  // the step is refused
    if (jacobians == nullptr) {
      cells_.Evaluate(cell_, residuals, nullptr);
      return true;
    }
    const int rows = cells_.rows(), columns = 3 * cells_.functions();
    std::vector<double> whole(static_cast<size_t>(rows) * columns);
    cells_.Evaluate(cell_, residuals, whole.data());
    for (int block = 0; block < cells_.functions(); ++block) {
      if (jacobians[block] == nullptr) continue;
      for (int r = 0; r < rows; ++r) {
        std::copy_n(whole.data() + static_cast<size_t>(r) * columns + 3 * block,
                    3,
                    jacobians[block] + 3 * r);
      }
    }
    return true;
  }

 private:
  const JointCells& cells_;
  const Projector& projector_;
  int cell_;
};

// Watches the noise, the user, and how well the damping suits.
class Watcher : public ceres::IterationCallback {
 public:
  Watcher(JointCells& cells,
          const JointOptions& options,
          double floor,
          Eigen::Index points,
          JointResult& result)
      : cells_(cells), options_(options), floor_(floor), points_(points), result_(result) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.step_is_successful) {
      const double squares = cells_.SquaredDistances();
      RoundSummary round;
      round.stage = "joint";
      round.rms = std::sqrt(squares / static_cast<double>(points_));
      round.score = 2 * summary.cost;
      round.seconds = summary.iteration_time_in_seconds;
      result_.rounds.push_back(round);
      if (summary.iteration > 0) {
        const double gain = summary.relative_decrease;
        cells_.damping =
            std::clamp(cells_.damping * std::max(0.2, 1 - std::pow(2 * gain - 1, 3)), 1e-9, 1e3);
      }
      if (squares <= floor_) {
        result_.note = "residuals reached the noise";
        return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
      }
    }
    if (options_.progress &&
        !options_.progress("optimize",
                           static_cast<double>(summary.iteration) / options_.max_iterations)) {
      result_.cancelled = true;
      return ceres::SOLVER_ABORT;
    }
    return ceres::SOLVER_CONTINUE;
  }

 private:
  JointCells& cells_;
  const JointOptions& options_;
  double floor_;
  Eigen::Index points_;
  JointResult& result_;
};

}  // namespace

JointResult OptimizeJointly(const NurbsSurface& surface,
                            const Eigen::Matrix3Xd& points,
                            const Eigen::VectorXd& weights,
                            const Eigen::Matrix2Xd& parameters,
                            const JointOptions& options,
                            ThreadPool& pool) {
  JointCells cells(surface, points, weights, parameters, options, pool);
  JointResult result{surface, parameters, 0, 0, 0, false, "", {}};
  if (!cells.Project()) {
    result.note = "the surface has no normal in places";
    return result;
  }
  const double before = cells.SquaredDistances();
  const auto count = static_cast<double>(points.cols());
  result.rms_before = result.rms_after = std::sqrt(before / count);
  const double freedom = std::max(0.0, count - cells.control_points());
  const double floor = options.noise * options.noise * freedom;
  if (before <= floor) {
    result.note = "residuals are at the noise";
    return result;
  }

  Projector projector(cells);
  Watcher watcher(cells, options, floor, points.cols(), result);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &projector;
  ceres::Problem problem(problem_options);
  for (int cell = 0; cell < cells.cells(); ++cell) {
    std::vector<double*> blocks;
    for (const int k : cells.ControlPointsOf(cell)) blocks.push_back(cells.control_point(k));
    problem.AddResidualBlock(new CellCost(cells, projector, cell), nullptr, blocks);
  }
  ceres::Solver::Options solver;
  solver.max_num_iterations = options.max_iterations;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.num_threads = pool.threads();
  solver.initial_trust_region_radius = 1e3;
  solver.max_num_consecutive_invalid_steps = 20;
  solver.function_tolerance = 1e-4;
  solver.logging_type = ceres::SILENT;
  solver.update_state_every_iteration = true;
  solver.callbacks.push_back(&watcher);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  result.iterations = static_cast<int>(summary.iterations.size()) - 1;
  if (summary.termination_type == ceres::FAILURE && result.note.empty()) {
    result.note = "Ceres stopped: " + summary.message;
  }

  // Once more at what Ceres settled on; the start stays if nothing was gained.
  const bool valid = cells.Project();
  const double after = valid ? cells.SquaredDistances() : before;
  if (options.loss == Loss::kNone ? after < before : valid) {
    cells.Accept();
    result.surface = cells.Surface();
    result.parameters = cells.feet();
    result.rms_after = std::sqrt(after / count);
  }
  for (RoundSummary& round : result.rounds) {
    round.control_points_u = surface.size_u();
    round.control_points_v = surface.size_v();
  }
  return result;
}

}  // namespace batten
