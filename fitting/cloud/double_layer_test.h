// SPDX-License-Identifier: MIT
// Test for a double layer: two sheets so close that they look like one thick sheet.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "batten/fitting/neighbours.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Returns the share of 600 points, chosen at random by the seed, in whose neighbourhoods (120
// neighbours) the residuals of the least-squares quadric, which gives z over x and y, are bimodal:
// their kurtosis less their squared skewness, 1 for two values and 3 for a normal distribution, is
// below 1.6; the two modes are apart by a good part of the
// spacing; and the mode of a point does not follow that of its neighbours in the plane, as it would
// where the surface bends more than a quadric. Points (3 × m) have no gross outliers and are those
// of the index; the result is 0 below 240 of them. Sheets more than four spacings apart have
// separate neighbourhoods, unless neighbours are searched in a plane. One sheet, however noisy,
// bent, creased or rounded, stays below 0.01, and below 0.06 if it has waves shorter than eight
// spacings; two parallel sheets one to three spacings apart exceed 0.7. O(600 · 120²).
double DoubleLayerFraction(const Eigen::Matrix3Xd& points,
                           const NeighbourIndex& index,
                           std::uint64_t seed,
                           ThreadPool& pool);

}  // namespace batten::internal
