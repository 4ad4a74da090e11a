// SPDX-License-Identifier: MIT
// Evaluates a tensor-product spline's coefficient net at scattered points.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_rows.h"
#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// d × m values of a net d × (n_outer · n_inner), inner fastest, repeated coefficients too, at the
// parameters of points; of these nothing else is read. inner: null for a curve. Rounding is that of
// sums of basis functions times coefficients. O(d (p+1)(q+1) m).
Eigen::MatrixXd NetValues(const SplineBasis& outer,
                          const SplineBasis* inner,
                          const Eigen::MatrixXd& net,
                          PointRows points,
                          ThreadPool& pool);

}  // namespace batten::internal
