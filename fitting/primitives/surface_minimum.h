// SPDX-License-Identifier: MIT
// Orthogonal-distance minimization for a surface of one kind by Levenberg–Marquardt and
// Gauss–Newton.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/thread_pool.h"
#include "fitting/primitives/fitted_surface.h"
#include "fitting/primitives/shape_data.h"
#include "fitting/primitives/shape_descent.h"

namespace batten::internal {

using SurfaceForm = ShapeForm<7>;  // by the freedoms of SurfaceDistance
using SurfaceMinimum = ShapeMinimum<FittedSurface, 7>;

// Sums block by block, so that the result does not depend on the number of threads. O(m).
SurfaceForm FormOf(const FittedSurface& shape,
                   const ShapeData& data,
                   const ShapeLoss& loss,
                   ThreadPool& pool);

// The shape after a step in its freedoms.
FittedSurface Moved(const FittedSurface& shape, const Eigen::Matrix<double, 7, 1>& step);

// The local minimum of Σ w ρ(d) below `start` (ShapeDescent). O(m) a step; two to four are usual.
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
