// SPDX-License-Identifier: MIT
// Surfaces near all points of a grid: least squares, and within a tolerance.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "batten/fitting/grid_data.h"
#include "batten/fitting/grid_parameters.h"
#include "batten/fitting/interpolate_grid.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct GridLeastSquaresOptions {
  int degree_u = 3, degree_v = 3;  // 1 … 25
  int control_u = 0,
      control_v = 0;  // different ones; more than the degree, at most as many as lines
  GridParameterization parameterization = GridParameterization::kAuto;
  GridParameters parameters = {};  // for kGiven
  bool meet_corners = true;        // exactly; edges are then the fits of the edges' points
  GridClosing closed = {};
};

// The least Σ |S(u_i, v_j) − Q_ij|² over the control points, solved as a tensor product: one banded
// factor a direction. Knots are placed by the parameters' density. Poles stay.
// Where there are as many control
// points as lines in a direction, it is interpolation there. O(rows·columns·(p + q)). Throws
// std::invalid_argument, with a sentence for the user, where cells are missing, sizes don't fit or
// neighbouring lines lie in one place. [Piegl & Tiller 1997, §9.4.3, A9.7]
InterpolatedGrid LeastSquaresGrid(const PointNet& net,
                                  const GridLeastSquaresOptions& options,
                                  ThreadPool& pool);

// Which directions' first and last lines are met: the control points there are then those of the
// lines' own fits.
struct MetEnds {
  bool u = false, v = false;
};

// The same over given bases, at given parameters inside their domains. Edges that are poles are met
// and stay collapsed.
NurbsSurface LeastSquaresOver(const SplineBasis& basis_u,
                              const SplineBasis& basis_v,
                              const PointNet& net,
                              const GridParameters& parameters,
                              const MetEnds& met,
                              ThreadPool& pool);

// A surface that keeps a tolerance everywhere.
struct ToleratedGrid {
  NurbsSurface surface;
  GridParameters parameters;  // of the lines, in the surface's domain
  double error = 0;           // no place is farther from the surface through all points: a bound
  bool interpolates = false;  // it is that surface
};

// The surface with the fewest control points found that is within `tolerance` (> 0, the data's
// units) of the surface through all points, at every parameter, between the points too; which is
// proven by the control nets of both over common knots, not sampled. What that surface may itself
// be off between the points is estimated, from every second line, and kept back from the tolerance;
// directions in which that is half of it keep their lines. Spans of a direction
// are placed where they make its errors equal (grid_knot_placement.h); pairs of span counts are
// tried from the fewest control points on, least squares on samples of the surface through all
// points, until one keeps the tolerance. Where none does with fewer control points, the surface
// through all points is the answer. O(rows·columns·p) and some hundred fits of one direction's
// lines. Throws as InterpolateGrid does, and std::invalid_argument unless the tolerance is
// positive; Cancelled when progress stops it. [Piegl & Tiller 1997, §9.4.4; de Boor 1973]
ToleratedGrid ApproximateGrid(const PointNet& net,
                              double tolerance,
                              const GridInterpolationOptions& options,
                              ThreadPool& pool,
                              const Progress& progress = {});

}  // namespace batten
