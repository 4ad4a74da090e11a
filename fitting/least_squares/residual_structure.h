// SPDX-License-Identifier: MIT
// Tests residuals of a surface fit for smooth structure and for double layers.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Signed residuals at parameters that are lengths (2 × m).
struct SurfaceResiduals {
  Eigen::Matrix2Xd parameters;
  Eigen::VectorXd residuals;
  std::uint64_t seed = 1;  // seed of the places sampled
};

// The share of the residuals' variance that quadrics over half a knot cell explain. It is about 0
// for noise, even noise correlated over a small part of a cell. Free parameters, weights and knots
// can only reduce residuals that are smooth at that width.
double StructuredShare(const SurfaceResiduals& residuals, int control_points, ThreadPool& pool);

// The share of places around which residuals cluster at two heights (DoubleLayerFraction), whatever
// the distance between the two.
double DoubleLayerFractionOf(const SurfaceResiduals& residuals, ThreadPool& pool);

}  // namespace batten::internal
