// SPDX-License-Identifier: MIT
#include "fitting/joint/joint_optimization.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "fitting/core/unit_of.h"
#include "fitting/joint/eliminated_problem.h"
#include "fitting/joint/gauss_newton.h"
#include "fitting/joint/iteration_monitor.h"
#include "fitting/joint/joint_ceres.h"

namespace batten::internal {
namespace {

// Weights of geometric mean 1: their common factor says nothing.
Eigen::VectorXd Normalised(const Eigen::VectorXd& weights) {
  return weights / std::exp(weights.array().log().mean());
}

FittingProblem AtShape(const FittingProblem& problem, const EliminatedProblem& cells) {
  const TensorShape& shape = cells.shape();
  const FittingProblem moved = problem.WithParameters(cells.feet());
  return shape.basis_v ? moved.WithBases(shape.basis_u, *shape.basis_v)
                       : moved.WithBasis(shape.basis_u);
}

// Which blocks hold a fixed control point.
std::vector<bool> FixedBlocks(const EliminatedProblem& cells, const JointOptions& options) {
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

// The robust sum that is minimised, of points and terms, without what only calms the steps; nothing
// where a term cannot be evaluated.
std::optional<double> Misfit(const EliminatedProblem& cells, const JointTerms& terms) {
  double misfit = cells.RobustSquares();
  for (const std::unique_ptr<TermCost>& term : terms) {
    std::vector<double> residuals(static_cast<size_t>(term->num_residuals()));
    if (!term->Evaluate(nullptr, residuals.data(), nullptr)) return std::nullopt;
    for (const double r : residuals) misfit += r * r;
  }
  return std::isfinite(misfit) ? std::make_optional(misfit) : std::nullopt;
}

JointTerms MakeTerms(const EliminatedProblem& cells, const JointOptions& options, double unit) {
  JointTerms terms;
  for (const std::shared_ptr<const ResidualTerm>& term : options.terms)
    terms.push_back(std::make_unique<TermCost>(term, cells, unit));
  return terms;
}

// All in units in which the shape has about the size 1; `unit` is theirs.
JointResult OptimizeScaled(const FittingProblem& problem,
                           const Eigen::MatrixXd& control_points,
                           const Eigen::VectorXd& weights,
                           const JointOptions& options,
                           double unit,
                           ThreadPool& pool) {
  EliminatedProblem cells(problem, control_points, weights, options, pool);
  JointResult result{problem, control_points, cells.shape().weights};
  if (!cells.Project()) {
    result.note = "the shape cannot be evaluated";
    return result;
  }
  const JointTerms terms = MakeTerms(cells, options, unit);
  const std::optional<double> misfit = Misfit(cells, terms);
  const double before = cells.SquaredDistances();
  const auto count = static_cast<double>(std::max<Eigen::Index>(1, problem.size()));
  result.rms_before = result.rms_after = std::sqrt(before / count);
  if (!misfit) {
    result.note = "a residual term cannot be evaluated at the start";
    return result;
  }
  result.misfit_after = *misfit;
  if (IterationMonitor::AtNoise(cells, options)) {
    result.SayAtNoise();
    return result;
  }

  if (options.max_iterations == 0) return result;
  const std::vector<bool> fixed = FixedBlocks(cells, options);
  JointTerms felt = MakeTerms(cells, options, unit);
  std::erase_if(felt,
                [&](const std::unique_ptr<TermCost>& term) { return !term->SeesFree(fixed); });
  const bool plain = options.loss == Loss::kNone && felt.empty();
  if (cells.only_points() && felt.empty()) {
    DescendJointly(cells, fixed, options, pool, result);
  } else {
    MinimiseByCeres(cells, fixed, std::move(felt), options, result);
  }

  // Once more at what that settled on; the start stays if nothing was gained.
  if (!cells.Return()) return result;
  const double after = cells.SquaredDistances();
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
  result.misfit_after *= unit * unit;
  for (RoundSummary& round : result.rounds) {
    round.rms *= unit;
    round.score *= unit * unit;
  }
  return result;
}

}  // namespace batten::internal
