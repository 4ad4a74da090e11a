// SPDX-License-Identifier: MIT
// The joint optimisation of control points, weights, knots and every point's parameters.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/fitting_problem.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/joint/joint_options.h"
#include "fitting/joint/joint_result.h"

namespace batten::internal {

// Minimises Σ w ρ(d_k), d_k the distance of datum k, over the control points and whatever else is
// free. Parameters are eliminated: at a foot point only the distance along the normal is left of a
// residual, so a point adds one row R_ij(u,v)·n (more at the domain's edges) to the block of its
// knot cell. All points are projected and sorted into cells before every evaluation, so points that
// cross knots are never extrapolated. Steps are damped by the point-distance matrix, and those that
// turn a normal over are refused. Where nothing but control points is free, steps are solved by
// block-banded factorisation; user's terms, weights and knots go to Ceres. Weights are free as
// logarithms, knots as logarithms of their gaps. The result is never worse than the start: in rms,
// or, with a loss or terms, in misfit. `problem` gives bases, data (points, d = 3, or 2 for plane
// curves), and parameters to start from, foot points if they are free; `weights` may be empty.
// Throws std::invalid_argument where sizes do not agree or an index is out of range. [Golub &
// Pereyra 2003, on variable projection; Wang, Pottmann & Liu 2006, on point and tangent distance]
JointResult OptimizeJointly(const FittingProblem& problem,
                            const Eigen::MatrixXd& control_points,
                            const Eigen::VectorXd& weights,
                            const JointOptions& options,
                            ThreadPool& pool);

}  // namespace batten::internal
