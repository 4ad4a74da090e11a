// SPDX-License-Identifier: MIT
#include "fitting/knots/knot_descent.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#include <ceres/ceres.h>
#pragma GCC diagnostic pop

#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Below this share of the largest, an eigenvalue of a matrix made of differences is rounding.
constexpr double kRoundedEigenvalue = 1e-13;

// An orthonormal basis of the vectors of sum zero, n × (n−1). [Helmert 1876]
RowMatrix SumZero(int n) {
  RowMatrix Z = RowMatrix::Zero(n, n - 1);
  for (int j = 1; j < n; ++j) {
    const double unit = 1 / std::sqrt(static_cast<double>(j) * (j + 1));
    Z.col(j - 1).head(j).setConstant(unit);
    Z(j, j - 1) = -j * unit;
  }
  return Z;
}

// Logarithms of gaps of mean zero; steps are cut to kFarthestLogGap in each of them.
class GapManifold : public ceres::Manifold {
 public:
  explicit GapManifold(int gaps) : Z_(SumZero(gaps)) {}
  int AmbientSize() const override { return static_cast<int>(Z_.rows()); }
  int TangentSize() const override { return static_cast<int>(Z_.cols()); }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Eigen::VectorXd step = Z_ * Eigen::Map<const Eigen::VectorXd>(delta, TangentSize());
    Eigen::Map<Eigen::VectorXd> moved(x_plus_delta, AmbientSize());
    moved = Eigen::Map<const Eigen::VectorXd>(x, AmbientSize()) +
            step.cwiseMax(-kFarthestLogGap).cwiseMin(kFarthestLogGap);
    moved.array() -= moved.sum() / AmbientSize();
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<RowMatrix>(jacobian, AmbientSize(), TangentSize()) = Z_;
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Eigen::VectorXd>(y_minus_x, TangentSize()) =
        Z_.transpose() * (Eigen::Map<const Eigen::VectorXd>(y, AmbientSize()) -
                          Eigen::Map<const Eigen::VectorXd>(x, AmbientSize()));
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<RowMatrix>(jacobian, TangentSize(), AmbientSize()) = Z_.transpose();
    return true;
  }

 private:
  RowMatrix Z_;
};

// As few rows as there are variables, and one, that have the cost, gradient and Gauss–Newton matrix
// of all the data: with H = VΛVᵀ, rows Λ^½Vᵀ and residuals Λ^−½Vᵀg, and what is left of the cost in
// a row that does not change.
void Compress(const Eigen::MatrixXd& H,
              const Eigen::VectorXd& g,
              double cost,
              Eigen::Ref<RowMatrix> rows,
              double* residuals) {
  const auto n = static_cast<int>(g.size());
  const Eigen::VectorXd scale =
      H.diagonal().unaryExpr([](double h) { return h > 0 ? std::sqrt(h) : 1.0; });
  const Eigen::MatrixXd unit =
      scale.cwiseInverse().asDiagonal() * H * scale.cwiseInverse().asDiagonal();
  const auto [values, vectors] = EigenOf(unit);
  const Eigen::VectorXd roots =
      values.cwiseMax(kRoundedEigenvalue * std::max(1.0, values[n - 1])).cwiseSqrt();
  rows.topRows(n) = roots.asDiagonal() * vectors.transpose() * scale.asDiagonal();
  rows.row(n).setZero();
  Eigen::VectorXd r = (vectors.transpose() * g.cwiseQuotient(scale)).cwiseQuotient(roots);
  const double explained = r.squaredNorm();
  if (explained > cost) r *= std::sqrt(cost / explained);
  Eigen::Map<Eigen::VectorXd>(residuals, n) = r;
  residuals[n] = std::sqrt(std::max(0.0, cost - r.squaredNorm()));
}

// Φ in the logarithms of the gaps of one or two directions.
class KnotCost : public ceres::CostFunction {
 public:
  KnotCost(const VariableProjection& projection, const MovingKnots& knots, ThreadPool& pool)
      : projection_(projection), knots_(knots), pool_(pool) {
    variables_ = 0;
    for (const int free : {knots.free_u(), knots.free_v()}) {
      if (free == 0) continue;
      mutable_parameter_block_sizes()->push_back(free + 1);
      variables_ += free + 1;
    }
    set_num_residuals(variables_ + 1);
  }

  // Whether there is a cost where Ceres is to begin, which must be known before, since it would
  // print otherwise. What was computed serves Ceres' first evaluation.
  bool Begin(double const* const* blocks) {
    const auto knots = At(blocks);
    if (knots) first_ = projection_.Linearise(*knots, pool_);
    return first_.has_value();
  }

  // The knots that Ceres' parameter blocks stand for.
  std::optional<MovingKnots> At(double const* const* blocks) const {
    MovingKnots knots = knots_;
    int block = 0;
    const auto move = [&](KnotGaps& gaps) {
      const Eigen::Map<const Eigen::VectorXd> x(blocks[block++], gaps.groups() + 1);
      auto moved = gaps.At(x);
      if (moved) gaps = std::move(*moved);
      return moved.has_value();
    };
    if (knots.free_u() > 0 && !move(knots.u)) return std::nullopt;
    if (knots.free_v() > 0 && !move(*knots.v)) return std::nullopt;
    return knots;
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const auto knots = At(blocks);
    if (!knots) return false;
    if (jacobians == nullptr) {
      const auto value = projection_.Evaluate(*knots, pool_);
      if (!value) return false;
      std::fill_n(residuals, num_residuals(), 0.0);
      residuals[0] = std::sqrt(std::max(0.0, value->cost));
      return true;
    }
    const auto value =
        first_ ? std::exchange(first_, std::nullopt) : projection_.Linearise(*knots, pool_);
    if (!value) return false;
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(knots->free(), variables_);  // ∂t/∂x
    const int u = knots->free_u(), v = knots->free_v(), columns_u = u > 0 ? u + 1 : 0;
    if (u > 0) T.topLeftCorner(u, columns_u) = knots->u.Derivatives();
    if (v > 0) T.bottomRightCorner(v, v + 1) = knots->v->Derivatives();
    RowMatrix rows(num_residuals(), variables_);
    Compress(T.transpose() * value->normal * T,
             T.transpose() * value->gradient,
             std::max(0.0, value->cost),
             rows,
             residuals);
    int first = 0;
    for (size_t block = 0; block < parameter_block_sizes().size(); ++block) {
      const int size = parameter_block_sizes()[block];
      if (jacobians[block])
        Eigen::Map<RowMatrix>(jacobians[block], num_residuals(), size) =
            rows.middleCols(first, size);
      first += size;
    }
    return true;
  }

 private:
  const VariableProjection& projection_;
  const MovingKnots& knots_;
  ThreadPool& pool_;
  int variables_;
  mutable std::optional<ProjectedSquares> first_;
};

double NarrowestShare(const KnotGaps& gaps) {
  const int g = gaps.NarrowestMergeable();
  if (g < 0) return std::numeric_limits<double>::infinity();
  return (gaps.knot(g + 1) - gaps.knot(g)) / gaps.length();
}

// The narrowest gap between groups that may be merged, as a share of its domain.
double NarrowestShare(const MovingKnots& knots) {
  double share = std::numeric_limits<double>::infinity();
  if (knots.free_u() > 0) share = std::min(share, NarrowestShare(knots.u));
  if (knots.free_v() > 0) share = std::min(share, NarrowestShare(*knots.v));
  return share;
}

MovingKnots Coalesced(MovingKnots knots, double share) {
  if (knots.free_u() > 0) knots.u = knots.u.Coalesced(share * knots.u.length());
  if (knots.free_v() > 0) knots.v = knots.v->Coalesced(share * knots.v->length());
  return knots;
}

class Watcher : public ceres::IterationCallback {
 public:
  Watcher(const KnotCost& cost,
          const std::vector<double*>& blocks,
          const DescentOptions& options,
          bool merges)
      : cost_(cost), blocks_(blocks), options_(options), merges_(merges) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (options_.stop && options_.stop()) {
      stopped = true;
      return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    }
    if (!summary.step_is_successful) return ceres::SOLVER_CONTINUE;
    if (2 * summary.cost <= options_.stop_squares) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    if (merges_) {
      const auto knots = cost_.At(blocks_.data());
      if (knots && NarrowestShare(*knots) < options_.coalesce)
        return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    }
    return ceres::SOLVER_CONTINUE;
  }

  bool stopped = false;

 private:
  const KnotCost& cost_;
  const std::vector<double*>& blocks_;
  const DescentOptions& options_;
  bool merges_;
};

// One run of Ceres, with the groups as they are. Returns whether it was told to stop.
bool Run(const VariableProjection& projection,
         const DescentOptions& options,
         bool merges,
         ThreadPool& pool,
         Descent& descent) {
  const MovingKnots start = descent.knots;
  if (start.free() == 0 || options.max_iterations <= descent.iterations) return false;
  Eigen::VectorXd x_u, x_v;
  std::vector<double*> blocks;
  ceres::Problem problem;
  auto* cost = new KnotCost(projection, start, pool);
  if (start.free_u() > 0) blocks.push_back((x_u = start.u.Variables()).data());
  if (start.free_v() > 0) blocks.push_back((x_v = start.v->Variables()).data());
  problem.AddResidualBlock(cost, nullptr, blocks);
  for (size_t b = 0; b < blocks.size(); ++b)
    problem.SetManifold(blocks[b], new GapManifold(cost->parameter_block_sizes()[b]));
  if (!cost->Begin(blocks.data())) return false;
  Watcher watcher(*cost, blocks, options, merges);
  ceres::Solver::Options solver;
  solver.max_num_iterations = options.max_iterations - descent.iterations;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.num_threads = 1;
  solver.initial_trust_region_radius = 1e2;
  solver.function_tolerance = options.tolerance;
  solver.parameter_tolerance = 1e-12;
  solver.gradient_tolerance = 1e-300;
  solver.max_num_consecutive_invalid_steps = 20;
  solver.logging_type = ceres::SILENT;
  solver.update_state_every_iteration = true;
  solver.callbacks.push_back(&watcher);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  descent.iterations += std::max(0, static_cast<int>(summary.iterations.size()) - 1);
  const auto knots = cost->At(blocks.data());
  if (knots) {
    const auto value = projection.Evaluate(*knots, pool);
    if (value && value->cost < descent.cost) {
      descent.knots = *knots;
      descent.cost = value->cost;
    }
  }
  return watcher.stopped;
}

}  // namespace

Descent Descend(const VariableProjection& projection,
                const MovingKnots& start,
                const DescentOptions& options,
                ThreadPool& pool) {
  Descent descent{start, std::numeric_limits<double>::infinity(), 0};
  const auto value = projection.Evaluate(start, pool);
  if (!value) return descent;
  descent.cost = value->cost;
  bool merges = true;
  for (;;) {
    const bool stopped = Run(projection, options, merges, pool, descent);
    if (stopped || !merges || !(NarrowestShare(descent.knots) < options.coalesce)) return descent;
    // Merge, unless that costs more than rounding.
    Descent merged{Coalesced(descent.knots, options.coalesce), 0, descent.iterations};
    const auto after = projection.Evaluate(merged.knots, pool);
    merged.cost = after ? after->cost : std::numeric_limits<double>::infinity();
    if (merged.cost <= descent.cost * (1 + 1e-4)) {
      descent = std::move(merged);
    } else {
      merges = false;
    }
  }
}

}  // namespace batten::internal
