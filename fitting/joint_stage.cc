// SPDX-License-Identifier: MIT
#include "batten/fitting/joint_stage.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#include <ceres/ceres.h>
#pragma GCC diagnostic pop

#include "batten/fitting/joint_cells.h"
#include "batten/fitting/term_cost.h"
#include "batten/fitting/unit_of.h"

namespace batten {
namespace {

constexpr int kDenseUnknowns = 250;  // up to here a dense factorisation is faster
constexpr double kExactRms = 4e-9;   // of the size: exact for CAD; on from here while it falls fast
constexpr double kRoundingRms = 1e-13;  // of the size: nothing is left but rounding
constexpr double kFast = 0.25;          // of the rms before, left by a fast step
constexpr double kRadius = 1e8;
constexpr int kMostRefusals = 12;
constexpr double kFirstDamping = 1e-2, kLeastFaded = 1e-9;
constexpr int kRenewal = 20;
constexpr double kValleyRadius = 1e4;
constexpr double kLeastDamping = 1e-9, kMostDamping = 1e3;

// Projects and sorts the points whenever Ceres looks at a new place.
class Projector : public ceres::EvaluationCallback {
 public:
  explicit Projector(JointCells& cells) : cells_(cells) {}
  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override {
    // Ceres asks for Jacobians where it starts, which is no step to be refused, and where it has
    // accepted one.
    if (new_evaluation_point) valid_ = evaluate_jacobians ? cells_.Return() : cells_.Project();
    if (evaluate_jacobians && valid_) cells_.Accept();
  }
  bool valid() const { return valid_; }

 private:
  JointCells& cells_;
  bool valid_ = true;
};

// The residuals of one knot cell.
class CellCost : public ceres::CostFunction {
 public:
  // `idle`: for a cell of which everything is fixed, an unknown that nothing depends on. Ceres
  // leaves out blocks without a free unknown, but points may move into the cell and out of it.
  CellCost(const JointCells& cells, const Projector& projector, int cell, double* idle)
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

  std::vector<double*> Blocks(JointCells& cells) const {
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
  const JointCells& cells_;
  const Projector& projector_;
  int cell_;
  double* idle_;
};

bool AtNoise(const JointCells& cells, const JointOptions& options) {
  if (!options.stop_at_noise) return false;
  const JointCells::Explained explained = cells.NoiseShare();
  return explained.squares <= (1 + options.noise_slack) * explained.by_noise;
}

// Watches the noise, the user, and how well the damping suits.
class Watcher : public ceres::IterationCallback {
 public:
  Watcher(JointCells& cells, const JointOptions& options, JointResult& result)
      : cells_(cells), options_(options), result_(result) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    const bool start = summary.iteration == 0;
    const int iterations = result_.iterations + summary.iteration;
    if (options_.progress &&
        !options_.progress("optimize", static_cast<double>(iterations) / options_.max_iterations)) {
      result_.cancelled = true;
      return ceres::SOLVER_ABORT;
    }
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
    return Settled() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

  // Whether the last step was refused and another is worth trying.
  bool tries_again() const {
    return refusals_ > 0 && refusals_ <= kMostRefusals && !result_.cancelled;
  }

 private:
  bool Settled() {
    if (AtNoise(cells_, options_)) {
      result_.note = kAtNoise;
      return true;
    }
    const std::vector<RoundSummary>& rounds = result_.rounds;
    const double rms = rounds.back().rms;
    const bool fast = rounds.size() > 1 && rms < kFast * rounds[rounds.size() - 2].rms;
    return rms <= (fast ? kRoundingRms : kExactRms) * options_.size;
  }

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
        std::clamp(kFirstDamping * std::pow(0.5, summary.iteration % kRenewal) * ratio * ratio,
                   kLeastFaded,
                   kMostDamping);
    return Settled() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

  void Damp(double factor) {
    cells_.damping = std::clamp(cells_.damping * factor, kLeastDamping, kMostDamping);
  }

  void Record(const ceres::IterationSummary& summary) {
    RoundSummary round;
    round.stage = "joint";
    round.control_points_u = cells_.shape().basis_u.size();
    round.control_points_v = cells_.shape().size_v();
    round.rms = std::sqrt(cells_.SquaredDistances() / static_cast<double>(cells_.feet().cols()));
    round.score = 2 * summary.cost;
    round.seconds = summary.iteration_time_in_seconds;
    result_.rounds.push_back(round);
  }

  JointCells& cells_;
  const JointOptions& options_;
  JointResult& result_;
  int refusals_ = 0;
};

// Weights of geometric mean 1: their common factor says nothing.
Eigen::VectorXd Normalised(const Eigen::VectorXd& weights) {
  return weights / std::exp(weights.array().log().mean());
}

FittingProblem AtShape(const FittingProblem& problem, const JointCells& cells) {
  const TensorShape& shape = cells.shape();
  const FittingProblem moved = problem.WithParameters(cells.feet());
  return shape.basis_v ? moved.WithBases(shape.basis_u, *shape.basis_v)
                       : moved.WithBasis(shape.basis_u);
}

// Which blocks hold a fixed control point.
std::vector<bool> FixedBlocks(const JointCells& cells, const JointOptions& options) {
  std::vector<bool> fixed(static_cast<size_t>(cells.blocks()), false);
  for (const int k : options.fixed_control_points) {
    if (k < 0 || k >= cells.shape().net.cols()) {
      throw std::invalid_argument("OptimizeJointly: fixed control point " + std::to_string(k) +
                                  " is not in [0, " + std::to_string(cells.shape().net.cols() - 1) +
                                  "]");
    }
    fixed[static_cast<size_t>(cells.BlockOf(k))] = true;
  }
  return fixed;
}

using Terms = std::vector<std::unique_ptr<TermCost>>;

// Every cell's block, every term's, and what is fixed.
void Assemble(ceres::Problem& problem,
              JointCells& cells,
              const Projector& projector,
              const JointOptions& options,
              Terms terms,
              double& idle) {
  const std::vector<bool> fixed = FixedBlocks(cells, options);
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

// The robust sum that is minimised, of points and terms, without what only calms the steps; nothing
// where a term cannot be evaluated.
std::optional<double> Misfit(const JointCells& cells, const Terms& terms) {
  double misfit = cells.RobustSquares();
  for (const std::unique_ptr<TermCost>& term : terms) {
    std::vector<double> residuals(static_cast<size_t>(term->num_residuals()));
    if (!term->Evaluate(nullptr, residuals.data(), nullptr)) return std::nullopt;
    for (const double r : residuals) misfit += r * r;
  }
  return std::isfinite(misfit) ? std::make_optional(misfit) : std::nullopt;
}

Terms MakeTerms(const JointCells& cells, const JointOptions& options, double unit) {
  Terms terms;
  for (const std::shared_ptr<const ResidualTerm>& term : options.terms)
    terms.push_back(std::make_unique<TermCost>(term, cells, unit));
  return terms;
}

ceres::Solver::Options SolverOptions(const JointOptions& options, const JointCells& cells) {
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

// All in units in which the shape has about the size 1; `unit` is theirs.
JointResult OptimizeScaled(const FittingProblem& problem,
                           const Eigen::MatrixXd& control_points,
                           const Eigen::VectorXd& weights,
                           const JointOptions& options,
                           double unit,
                           ThreadPool& pool) {
  JointCells cells(problem, control_points, weights, options, pool);
  JointResult result{problem, control_points, cells.shape().weights};
  if (!cells.Project()) {
    result.note = "the shape cannot be evaluated";
    return result;
  }
  const Terms terms = MakeTerms(cells, options, unit);
  const std::optional<double> misfit = Misfit(cells, terms);
  const double before = cells.SquaredDistances();
  const auto count = static_cast<double>(std::max<Eigen::Index>(1, problem.size()));
  result.rms_before = result.rms_after = std::sqrt(before / count);
  if (!misfit) {
    result.note = "a residual term cannot be evaluated at the start";
    return result;
  }
  result.misfit_before = result.misfit_after = *misfit;
  if (AtNoise(cells, options)) {
    result.note = kAtNoise;
    return result;
  }

  if (options.max_iterations == 0) return result;
  Projector projector(cells);
  Watcher watcher(cells, options, result);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &projector;
  ceres::Problem ceres_problem(problem_options);
  double idle = 0;
  Assemble(ceres_problem, cells, projector, options, MakeTerms(cells, options, unit), idle);
  ceres::Solver::Options solver = SolverOptions(options, cells);
  solver.callbacks.push_back(&watcher);
  ceres::Solver::Summary summary;
  do {
    solver.max_num_iterations = options.max_iterations - result.iterations;
    ceres::Solve(solver, &ceres_problem, &summary);
    result.iterations += static_cast<int>(summary.iterations.size()) - 1;
  } while (summary.termination_type == ceres::USER_SUCCESS && watcher.tries_again() &&
           result.iterations < options.max_iterations);
  if (summary.termination_type == ceres::FAILURE && result.note.empty()) {
    result.note = "Ceres stopped: " + summary.message;
  }

  // Once more at what Ceres settled on; the start stays if nothing was gained.
  if (!cells.Return()) return result;
  const double after = cells.SquaredDistances();
  const bool plain = options.loss == Loss::kNone && options.terms.empty();
  const std::optional<double> left = Misfit(cells, terms);
  if (left && (plain ? after < before : *left < *misfit)) {
    result.problem = AtShape(problem, cells);
    result.control_points = cells.shape().net;
    result.weights =
        options.free_weights ? Normalised(cells.shape().weights) : cells.shape().weights;
    result.rms_after = std::sqrt(after / count);
    result.misfit_after = *left;
  }
  return result;
}

}  // namespace

JointResult OptimizeJointly(const FittingProblem& problem,
                            const Eigen::MatrixXd& control_points,
                            const Eigen::VectorXd& weights,
                            const JointOptions& options,
                            ThreadPool& pool) {
  const double unit = std::max(UnitOf(problem.data().values), UnitOf(control_points));
  auto data = std::make_shared<FittingData>();
  data->parameters = problem.data().parameters;
  data->values = problem.data().values / unit;
  data->weights = problem.data().weights;
  JointOptions scaled = options;
  scaled.noise /= unit;
  scaled.size /= unit;
  scaled.loss_scale /= unit;
  scaled.weight_prior /= unit * unit;
  JointResult result = OptimizeScaled(
      problem.WithData(std::move(data)), control_points / unit, weights, scaled, unit, pool);
  result.problem = result.problem.WithData([&] {
    auto original = std::make_shared<FittingData>(problem.data());
    original->parameters = result.problem.data().parameters;
    return original;
  }());
  result.control_points *= unit;
  result.rms_before *= unit;
  result.rms_after *= unit;
  result.misfit_before *= unit * unit;
  result.misfit_after *= unit * unit;
  for (RoundSummary& round : result.rounds) {
    round.rms *= unit;
    round.score *= unit * unit;
  }
  return result;
}

}  // namespace batten
