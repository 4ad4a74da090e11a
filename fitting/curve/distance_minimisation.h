// SPDX-License-Identifier: MIT
// Orthogonal distance fitting of curves: point, tangent and squared distance minimisation.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// The quadratic model of the squared distance while the control points move:
// |r|² less (1 − τ)(r·t)², r from the point to the curve at the foot's parameter, t the tangent
// there.
enum class DistanceModel {
  kPoint,    // τ = 1: every datum holds its foot. Safe and slow [Hoschek 1988]
  kTangent,  // τ = 0: feet slide along the tangent [Blake & Isard 1998]
  kSquared,  // τ = a/(1 + a), a the distance over the radius of curvature, and 0 on the side of the
             // centre: the distance to second order, kept convex [Wang, Pottmann & Liu 2006].
             // Of points on both sides of a curve that clip leaves the pull of one: near the end it
             // is slower than kTangent with its damping.
};

struct DistanceMinimisationOptions {
  DistanceModel model = DistanceModel::kTangent;
  int max_rounds = 50;          // ≥ 0; rejected steps count
  double relative_gain = 1e-6;  // ≥ 0; a round that lowers the sum by less is the last
  double damping = 1e-2;        // in (0, 1]: the least τ to begin with
  Progress progress = nullptr;  // stops with what there is
};

struct DistanceMinimum {
  Eigen::MatrixXd control_points;  // d × n
  Eigen::VectorXd parameters;      // local foot points on it, each reached from the one before
  std::vector<double> rms;  // √(Σ w |r|² / Σ w): at the start, then after every accepted step
  int rounds = 0;           // solved, rejected ones included
  bool converged = false;   // by relative_gain, or because no step lowers the sum
};

// Lowers E = Σ w |C(u_k) − q_k|² + λ ∫ C″² over the control points, u_k the local foot points that
// the problem's parameters lead to; w and λ are the problem's, λ as at the start. Each round solves
// the quadratic model, moves, and corrects the feet. Steps that do not lower E are not taken: then
// τ is raised, for all points at least to a common damping, which falls again with steps that keep
// what the model promised. At damping 1 the step is that of point distances, which cannot fail, so
// that E never rises, whatever the curvature, and at ends, where τ is 1. Bases may be periodic.
// Throws std::invalid_argument unless the problem is a curve's of dimension 2 or 3, the net fits it
// and, over a periodic basis, repeats its first p points, and the options keep their rules.
// O(m p² d²) a round.
DistanceMinimum MinimiseDistance(const FittingProblem& problem,
                                 const Eigen::MatrixXd& control_points,
                                 const DistanceMinimisationOptions& options,
                                 ThreadPool& pool);

}  // namespace batten::internal
