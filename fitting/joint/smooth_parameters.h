// SPDX-License-Identifier: MIT
// Smoothing of scattered parameters into a smooth function of position.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/robust_loss.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// The scatter of parameters among neighbours: the standard deviation, in the data's units, that is
// not shared by neighbours of S(u_k, v_k) − q_k along the shape, beside that across it, which is
// noise.
struct ParameterScatter {
  double along = 0, across = 0;

  // Data whose noise has no direction have as much of it along as across (twice along a surface);
  // several times more comes from the parameters.
  bool rough() const { return along > 3 * across; }
};
ParameterScatter ScatterOf(const FittingProblem& problem,
                           const Eigen::MatrixXd& control_points,
                           ThreadPool& pool);

// A cascade of coarse shapes, from three spans a direction up to those of the problem, each twice
// as fine: a linear fit at the present parameters, a few joint steps, then every point's foot point
// becomes its parameters. Coarse shapes cannot follow the scatter of single points. Loss and scale
// are those of the joint steps. Bases must not be periodic.
struct SmoothedParameters {
  FittingProblem problem;  // the one given, at the new parameters
  int iterations = 0;      // of Ceres
};
SmoothedParameters WithSmoothParameters(const FittingProblem& problem,
                                        Loss loss,
                                        double loss_scale,
                                        ThreadPool& pool,
                                        const Progress& progress = {});

}  // namespace batten::internal
