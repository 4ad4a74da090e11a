// SPDX-License-Identifier: MIT
// What the parameters of a surface fit come from, and what coefficients over them mean.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/poles.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/plane_base.h"

namespace batten::internal {

// Every point's parameters, as lengths on the shape or in its plane. Over a plane the values are
// heights and coefficients are those of the control points above their Greville abscissae; over
// every other base the values are the points themselves.
struct Parameterization {
  std::string name;                // "plane", "sheet", "revolution" …
  std::string why;                 // one clause for the report
  std::string shape;               // what the data should be, as in "a smooth height field"
  std::optional<PlaneBase> plane;  // where values are heights
  Eigen::Matrix2Xd parameters;     // in [0, length_u] × [0, length_v]
  double length_u = 1, length_v = 1;
  // The parameter lives on a circle of length_u (length_v): the surface closes.
  bool periodic_u = false, periodic_v = false;
  Poles poles;         // edges v = 0 and v = length_v that are one point
  bool exact = false;  // parameters are part of the data: what is off along the surface counts too

  NurbsSurface Surface(const SplineBasis& basis_u,
                       const SplineBasis& basis_v,
                       const Eigen::MatrixXd& coefficients) const;

  // The problem of the points under a mask (of those the parameters belong to) over one span a
  // direction.
  FittingProblem ProblemOf(const PointCloud& points,
                           const PointMask& mask,
                           int degree_u,
                           int degree_v,
                           double smoothing) const;

  // Residuals of a problem's values at their parameters: the part along the surface's normal, or
  // all of it where parameters are exact (then not signed).
  Eigen::VectorXd Residuals(const FittingProblem& problem,
                            const Eigen::MatrixXd& coefficients,
                            ThreadPool& pool) const;
};

// How much lengths on a surface differ from those of its parameters: the root of the mean square of
// the principal stretches' difference from one, over some of the parameters given.
double DistortionAt(const NurbsSurface& surface, const Eigen::Matrix2Xd& parameters);

}  // namespace batten::internal
