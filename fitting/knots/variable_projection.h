// SPDX-License-Identifier: MIT
// A spline least-squares problem as a function of its knots alone: the coefficients are eliminated.
// Used by the free-knot search only.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "fitting/knots/knot_gaps.h"

namespace batten::internal {

// The knots of a curve (v empty) or a surface, with the directions that move.
struct MovingKnots {
  KnotGaps u;
  std::optional<KnotGaps> v;
  bool move_u = true, move_v = false;

  int free_u() const { return move_u ? u.groups() : 0; }
  int free_v() const { return move_v && v ? v->groups() : 0; }
  int free() const { return free_u() + free_v(); }
  int unknowns() const { return u.basis().size() * (v ? v->basis().size() : 1); }
};

// Φ(t) = min over c of Σ w |S_t(c) − z|² + λ cᵀPc at knots t.
struct ProjectedSquares {
  double cost = 0;     // Φ
  double squares = 0;  // its first part, Σ w |S − z|²
  // Filled by Linearise: with r the weighted residual and J = (I − P_B)(∂B/∂t)c its Jacobian with
  // respect to the free knots (u's groups, then v's) as Kaufman simplified it, JᵀJ and Jᵀr.
  // Fairness is part of the projection; its own change with the knots is left out of J.
  Eigen::MatrixXd normal;
  Eigen::VectorXd gradient;  // ½ ∂Φ/∂t, exact without fairness
};

// Holds the data; knots come with every call. Calls from several threads at once are safe when each
// has a pool of its own. [Golub & Pereyra 1973; Kaufman 1975, "A variable projection method for
// solving separable nonlinear least squares problems"]
class VariableProjection {
 public:
  explicit VariableProjection(const FittingProblem& problem);

  // Evaluates Φ; nothing where the data do not determine the coefficients, in the sense in which
  // SolveLinear would have to raise the smoothing. O(m + n · min(n_u, n_v)²).
  std::optional<ProjectedSquares> Evaluate(const MovingKnots& knots, ThreadPool& pool) const;

  // Evaluates with derivatives.
  std::optional<ProjectedSquares> Linearise(const MovingKnots& knots, ThreadPool& pool) const;

  // Σ |S − z|² w of every span of u (v: of every span of v) and the mean parameter of its points
  // weighted by their squared residuals; spans as in SplineBasis::Spans().
  struct SpanError {
    double lower, upper, squares, centroid;
  };
  struct SpanErrors {
    std::vector<SpanError> u, v;
  };
  std::optional<SpanErrors> Errors(const MovingKnots& knots, ThreadPool& pool) const;

  Eigen::Index size() const { return u_.size(); }         // m
  Eigen::Index values() const { return values_.size(); }  // m · d
  double squares() const { return squares_; }             // Σ w |z − z̄|²

  // At most about `count` of the data, evenly out of their order along the parameters.
  VariableProjection Thinned(Eigen::Index count) const;

 private:
  struct Solved;
  std::optional<Solved> Solve(const MovingKnots& knots, ThreadPool& pool) const;

  Eigen::VectorXd u_, v_;
  Eigen::MatrixXd values_;  // d × m, their mean taken off: splines hold constants
  Eigen::VectorXd weights_;
  FairnessEnergy energy_ = FairnessEnergy::kThinPlate;
  double smoothing_ = 0, squares_ = 0;
};

}  // namespace batten::internal
