// SPDX-License-Identifier: MIT
// The joint optimisation of control points and every point's parameters, by Ceres.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/robust_loss.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct JointOptions {
  int max_iterations = 40;
  double noise = 0;         // stop when Σd² falls to noise² (N − n); 0: never for that reason
  Loss loss = Loss::kNone;  // on each point's distance
  double loss_scale = 1;    // standard deviation of good points, the data's units
  double fairness = 1e-6;   // thin plate relative to the data, so that empty cells stay calm
  Progress progress = nullptr;
};

struct JointResult {
  NurbsSurface surface;
  Eigen::Matrix2Xd parameters;  // foot points on it
  int iterations = 0;           // of Ceres
  double rms_before = 0, rms_after = 0;
  bool cancelled = false;
  std::string note;  // why it ended, when that is worth a word
  std::vector<RoundSummary> rounds;
};

// Minimises Σ w ρ(d_k), d_k the orthogonal distance of point k, over the control points; weights
// and knots stay. Parameters are eliminated: at a foot point only the distance along the normal is
// left of a residual, so a point adds one row R_ij(u,v)·n (more at the domain's edges) to the block
// of its knot cell. Ceres' evaluation callback projects all points and sorts them into cells before
// every evaluation, so points that cross knots are never extrapolated. Steps are damped by the
// point-distance matrix, and those that turn a normal over are refused. The result is never worse
// than the start. `parameters` are foot points to start from; `weights` may be empty.
JointResult OptimizeJointly(const NurbsSurface& surface,
                            const Eigen::Matrix3Xd& points,
                            const Eigen::VectorXd& weights,
                            const Eigen::Matrix2Xd& parameters,
                            const JointOptions& options,
                            ThreadPool& pool);

}  // namespace batten
