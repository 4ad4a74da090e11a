// SPDX-License-Identifier: MIT
// Parameterization of a surface fit: the parameters of the points, and the meaning of coefficients.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/poles.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/plane_base.h"

namespace batten::internal {

// A base with the parameters of every point, as lengths on the shape or in its plane. Over a plane
// the fitted values are heights, and coefficients are the heights of the control points above their
// Greville abscissae; over every other base the values are the points themselves.
struct Parameterization {
  std::string name;                // "plane", "sheet", "revolution" …
  std::string why;                 // one clause for the report
  std::string shape;               // the expected shape of the data, as in "a smooth height field"
  std::optional<PlaneBase> plane;  // set if values are heights
  Eigen::Matrix2Xd parameters;     // in [0, length_u] × [0, length_v]
  double length_u = 1, length_v = 1;
  // The parameter is periodic with length_u (length_v): the surface is closed in that direction.
  bool periodic_u = false, periodic_v = false;
  // Of the grid whose surface the parameters were settled on: with uniform cells like these the
  // points are fitted to the noise, and the rectangle ends where they do. 0: unknown.
  int settled_cells_u = 0, settled_cells_v = 0;
  // The curve, over [0, length_v], that both edges u = 0 and u = length_u are: the surface closes
  // there in a sharp edge. Meant for points in space over a base that is periodic nowhere.
  std::optional<NurbsCurve<3>> sharp_edge;
  Poles poles;         // edges v = 0 and v = length_v that degenerate to a point
  bool exact = false;  // parameters are part of the data: residuals along the surface count too

  NurbsSurface Surface(const SplineBasis& basis_u,
                       const SplineBasis& basis_v,
                       const Eigen::MatrixXd& coefficients) const;

  // Moves the rectangle's corner by `shift`, over a plane with it, and gives it other sides; points
  // keep their places on the shape.
  void MoveRectangle(const Eigen::Vector2d& shift, const Eigen::Vector2d& sides);

  // Sets up the least-squares problem of the points under a mask (over the points the parameters
  // belong to) with one span in each direction.
  FittingProblem ProblemOf(const PointCloud& points,
                           const PointMask& mask,
                           int degree_u,
                           int degree_v,
                           double smoothing) const;

  // Residuals of a problem's values at their parameters: the component along the surface normal, or
  // the full distance if parameters are exact (then not signed).
  Eigen::VectorXd Residuals(const FittingProblem& problem,
                            const Eigen::MatrixXd& coefficients,
                            ThreadPool& pool) const;
};

// The surface's jets at some of the parameters given, enough for a mean.
std::vector<SurfaceJet> SomeJets(const NurbsSurface& surface, const Eigen::Matrix2Xd& parameters);

// Distortion of a surface's parameterization: the root mean square of the principal stretches'
// difference from one, over some of the parameters given.
double DistortionAt(const NurbsSurface& surface, const Eigen::Matrix2Xd& parameters);

}  // namespace batten::internal
