// SPDX-License-Identifier: MIT
// The covariance of a fitted shape's freedoms, with correlation between neighbouring residuals
// included. Used by the shape estimates only.
#pragma once

#include <Eigen/Core>

#include "fitting/primitives/fitted_surface.h"
#include "fitting/primitives/shape_data.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct FreedomCovariance {
  Eigen::MatrixXd covariance;  // of the freedoms of SurfaceDistance
  double inflation = 1;        // see ShapeEstimate
  bool determined = true;      // no direction in which the shape can move freely
};

// The covariance of the freedoms of `shape`. Points with weight zero do not count.
FreedomCovariance CovarianceOf(const FittedSurface& shape,
                               const ShapeData& data,
                               const ShapeLoss& loss,
                               double rounding,
                               ThreadPool& pool);

}  // namespace batten::internal
