// SPDX-License-Identifier: MIT
// Control points of a limit surface from points.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/solid/surface_feet.h"
#include "geometry/subdivision/limit_surface.h"

namespace batten::internal {

struct SurfaceData {
  Eigen::Matrix3Xd points, normals;  // normals: unit, or zero where there is none
  bool oriented = false;             // the signs of normals count
  Eigen::VectorXd weights;           // zero: does not count
  double noise = 0;                  // standard deviation, zero where not known
  PointMask left_out;                // while smoothing is chosen
};

// Every tenth of so many points, spread over them.
PointMask EveryTenth(Eigen::Index points);

// Beside creases faces are less even: measured on a part of 25 corners, one layout in four had
// folds at 0.2, two at 0.05, all at 0.01.
inline constexpr double kStretch = 0.01, kStretchBesideCreases = 0.2;

struct SurfaceFitSettings {
  std::optional<double> smoothing;  // λ over the data's scale; absent: cross-validated
  int max_iterations = 40;
  Progress progress;
  // Against uneven faces, relative to the data: it moves places along the surface, which hardly
  // changes its shape, and keeps faces from folding.
  double stretch = kStretch;
  // By patch of the stencils: has no points, what is beyond a border; empty: none.
  std::vector<char> left_out = {};
  // By vertex: its control point may move; empty: all may.
  std::vector<char> moves = {};

  bool Moves(Eigen::Index vertex) const { return moves.empty() || moves[std::size_t(vertex)]; }
};

struct LimitSurfaceFit {
  Eigen::Matrix3Xd control_points;
  std::vector<LimitFoot> feet;  // of all points
  std::vector<RoundSummary> rounds;
  double smoothing = 0;  // λ over the data's scale, given or chosen
  // Weighted squared distances of points left out, from the surface of that smoothing fitted
  // without them; empty where smoothing was given.
  Eigen::VectorXd held_out;
  Eigen::Matrix3Xd without;  // control points of that surface
};

// How much more points left out miss one surface than another, from their weighted squared
// distances: in standard errors of the difference point by point.
double Worse(const Eigen::VectorXd& one, const Eigen::VectorXd& other);

// Fits the surface from these control points on; see FitSolid. Damping by the tangential distance
// is the point-distance matrix restricted to the tangent plane: the foot points, eliminated, add
// nothing to the gradient. It falls where steps succeed and rises where they fail.
LimitSurfaceFit FitLimitSurface(const LimitStencils& stencils,
                                const Eigen::Matrix3Xd& start,
                                const SurfaceData& data,
                                const SurfaceFitSettings& settings,
                                ThreadPool& pool);

// Goes on from the control points of a coarser fit, all and `without` those left out, with the
// smoothing that these choose anew. None where points left out are not met better than by the
// coarser one.
std::optional<LimitSurfaceFit> FitFiner(const LimitStencils& stencils,
                                        const LimitSurfaceFit& coarse,
                                        const SurfaceData& data,
                                        const SurfaceFitSettings& settings,
                                        ThreadPool& pool);

// Control points near those of a mesh whose limit surface passes near its vertices.
Eigen::Matrix3Xd ControlPointsThrough(const QuadTopology& mesh, const Eigen::Matrix3Xd& vertices);

}  // namespace batten::internal
