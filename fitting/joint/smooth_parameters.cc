// SPDX-License-Identifier: MIT
#include "fitting/joint/smooth_parameters.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "batten/fitting/solve_linear.h"
#include "fitting/core/shared_constants.h"
#include "fitting/foot_points/joint_foot_points.h"
#include "fitting/joint/joint_optimization.h"
#include "fitting/least_squares/residual_noise.h"

namespace batten::internal {
namespace {

constexpr int kCoarsestSpans = 3;
constexpr int kStepsALevel = 8;

TensorShape ShapeOf(const FittingProblem& problem, const Eigen::MatrixXd& control_points) {
  return {problem.basis_u(),
          problem.is_curve() ? std::nullopt : std::make_optional(problem.basis_v()),
          control_points,
          Eigen::VectorXd::Ones(control_points.cols())};
}

SplineBasis Coarse(const SplineBasis& basis, int spans) {
  return SplineBasis::Uniform(basis.degree(), basis.degree() + spans, basis.lower(), basis.upper());
}

int SpanCount(const SplineBasis& basis) { return static_cast<int>(basis.Spans().size()); }

FittingProblem Coarse(const FittingProblem& problem, int spans) {
  const auto of = [&](const SplineBasis& basis) {
    return Coarse(basis, std::min(spans, SpanCount(basis)));
  };
  return problem.is_curve() ? problem.WithBasis(of(problem.basis_u()))
                            : problem.WithBases(of(problem.basis_u()), of(problem.basis_v()));
}

}  // namespace

ParameterScatter ScatterOf(const FittingProblem& problem,
                           const Eigen::MatrixXd& control_points,
                           ThreadPool& pool) {
  const FittingData& data = problem.data();
  const TensorShape shape = ShapeOf(problem, control_points);
  FootPointSet at, near;
  FootProjector(data.values, false, pool).Project(shape, data.parameters, at);
  FootProjector(data.values, true, pool).Project(shape, data.parameters, near);
  const ResidualNoise noise(data.parameters);
  const Eigen::MatrixXd along = at.difference - near.difference;
  return {std::sqrt(noise.Variance(along, data.weights)),
          std::sqrt(noise.Variance(near.difference, data.weights))};
}

SmoothedParameters WithSmoothParameters(const FittingProblem& problem,
                                        Loss loss,
                                        double loss_scale,
                                        ThreadPool& pool,
                                        const Progress& progress) {
  FittingProblem current = problem;
  int iterations = 0;
  const int most =
      std::max(SpanCount(problem.basis_u()), problem.is_curve() ? 1 : SpanCount(problem.basis_v()));
  const FootProjector projector(problem.data().values, true, pool);
  for (int spans = kCoarsestSpans; spans < most; spans *= 2) {
    const FittingProblem coarse = Coarse(current, spans);
    if (coarse.size() < 2 * coarse.unknowns()) break;
    const Eigen::MatrixXd net = SolveLinear(coarse, pool).coefficients;
    FootPointSet feet;
    projector.Project(ShapeOf(coarse, net), coarse.data().parameters, feet);
    JointOptions joint;
    joint.max_iterations = kStepsALevel;
    joint.least_gain = 1e-2;
    joint.fairness = kSurfaceSmoothing;
    joint.loss = loss;
    joint.loss_scale = loss_scale;
    joint.progress = progress;
    const JointResult result =
        OptimizeJointly(coarse.WithParameters(std::move(feet.parameters)), net, {}, joint, pool);
    current = problem.WithParameters(result.problem.data().parameters);
    iterations += result.iterations;
    if (result.cancelled) break;
  }
  return {std::move(current), iterations};
}

}  // namespace batten::internal
