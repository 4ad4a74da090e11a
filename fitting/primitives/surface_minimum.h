// SPDX-License-Identifier: MIT
// Orthogonal-distance minimization for a surface of one kind by Levenberg–Marquardt and
// Gauss–Newton.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "fitting/primitives/fitted_surface.h"
#include "fitting/primitives/shape_data.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Σ w ρ(d) with its gradient and Gauss–Newton matrix Σ w (ρ'/d) ∇d ∇dᵀ by the freedoms of
// SurfaceDistance; those that the kind does not have stay zero.
struct SurfaceForm {
  Eigen::Matrix<double, 7, 7> matrix = Eigen::Matrix<double, 7, 7>::Zero();
  Eigen::Matrix<double, 7, 1> gradient = Eigen::Matrix<double, 7, 1>::Zero();
  double cost = 0;
};

// Sums block by block, so that the result does not depend on the number of threads. O(m).
SurfaceForm FormOf(const FittedSurface& shape,
                   const ShapeData& data,
                   const ShapeLoss& loss,
                   ThreadPool& pool);

// The shape after a step in its freedoms.
FittedSurface Moved(const FittedSurface& shape, const Eigen::Matrix<double, 7, 1>& step);

struct SurfaceMinimum {
  FittedSurface shape;
  SurfaceForm form;  // there
  int steps = 0;
  bool converged = false;  // a whole Gauss–Newton step leads nowhere lower, or to rounding
};

// The local minimum of Σ w ρ(d) below `start`: Levenberg–Marquardt steps until the sum does not
// fall, then Gauss–Newton steps while its gradient does: the sum is flat to rounding while the
// gradient still tells the place. Never worse than the start. [Marquardt 1963; Moré 1978] O(m) a
// step; two to four are usual.
SurfaceMinimum Minimised(const FittedSurface& start,
                         const ShapeData& data,
                         const ShapeLoss& loss,
                         int most_steps,
                         ThreadPool& pool);

// Signed distances of points from `shape`. O(m).
Eigen::VectorXd SurfaceDistances(const FittedSurface& shape,
                                 const Eigen::Matrix3Xd& points,
                                 ThreadPool& pool);

}  // namespace batten::internal
