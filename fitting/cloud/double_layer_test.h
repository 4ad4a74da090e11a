// SPDX-License-Identifier: MIT
// Two sheets so close that they look like one thick sheet.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "batten/fitting/neighbours.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// A cloud with a greater share is two sheets. One sheet, however noisy, bent, creased or rounded,
// stays below 0.01, and below 0.06 where it waves within eight spacings; two parallel ones one to
// three spacings apart come above 0.7.
constexpr double kLayersAbove = 0.1;

struct LayerTestOptions {
  int samples = 600;       // points whose surroundings are looked at
  std::uint64_t seed = 1;  // chooses them
  // Where the sheets are charts of a plane: its unit normal. The surroundings tell when absent.
  std::optional<Eigen::Vector3d> heights = std::nullopt;
};

// The share of sampled points in whose surroundings (120 neighbours) the offsets from the
// least-squares quadric keep to two heights: their kurtosis less their squared skewness, 1 for two
// values and 3 for one normal, is below 1.6; the two are apart by a good part of the spacing; and
// which of them a point keeps to is not what its neighbours in the plane do, as it would be where
// the surface bends more than a quadric. Points (3 × m) without gross outliers, those of the index;
// 0 below 240 of them. Sheets more than four spacings apart have surroundings of their own, but
// where neighbours are those of a plane.
// O(samples · 120²).
double DoubleLayerFraction(const Eigen::Matrix3Xd& points,
                           const NeighbourIndex& index,
                           const LayerTestOptions& options,
                           ThreadPool& pool);

}  // namespace batten::internal
