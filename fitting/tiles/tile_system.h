// SPDX-License-Identifier: MIT
// The net over given bases, from moments over finer ones.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/least_squares/coarser_moments.h"

namespace batten::internal {

// Moments of points over the spans of clamped bases.
struct FoldedPoints {
  SplineBasis basis_u, basis_v;
  CellMoments moments;
};

struct TileNet {
  SplineBasis basis_u, basis_v;
  Eigen::MatrixXd rows;      // coefficients, v fastest × d
  CellErrors errors;         // of the cells of these bases
  double residual = 0;       // of the normal equations, relative
  bool regularised = false;  // fairness was raised: the points do not determine the coefficients
};

// Minimises Σ w |S − z|² + λ ∫∫ S_uu² + 2 S_uv² + S_vv² over bases whose knots are among those of
// the points', λ as FittingProblem has it, where `smoothing` below 1e-7 counts as that: a net so
// large has cells without points. From `start`, a net over some of the knots, or from zero. `each`
// as SolveByBoxes has it. Throws std::invalid_argument where no fairness makes the system definite.
TileNet SolveNet(const FoldedPoints& points,
                 const SplineBasis& basis_u,
                 const SplineBasis& basis_v,
                 double smoothing,
                 const TileNet* start,
                 ThreadPool& pool,
                 const std::function<void()>& each = {});

}  // namespace batten::internal
