// SPDX-License-Identifier: MIT
// What residuals of a surface are: noise, a shape the surface has missed, or two sheets.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Signed residuals at parameters that are lengths (2 × m).
struct SurfaceResiduals {
  Eigen::Matrix2Xd parameters;
  Eigen::VectorXd residuals;
  std::uint64_t seed = 1;  // chooses the places that are looked at
};

// The share of the residuals' variance that is smooth over half a knot cell: explained by quadrics
// there. About 0 of noise, whatever neighbours share of it within a small part of a cell. Free
// parameters, weights and knots can only mend what is smooth at that width.
double StructuredShare(const SurfaceResiduals& residuals, int control_points, ThreadPool& pool);

// The share of places in whose surroundings residuals keep to two heights (DoubleLayerFraction),
// whatever the distance of the two.
double DoubleLayerFractionOf(const SurfaceResiduals& residuals, ThreadPool& pool);

}  // namespace batten::internal
