// SPDX-License-Identifier: MIT
// Masks over the points of a cloud, and random samples of their indices.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace batten {

using PointMask = Eigen::Array<bool, Eigen::Dynamic, 1>;

// Draws `count` different indices of [0, size), in increasing order; all of them if count ≥ size.
std::vector<Eigen::Index> SampleIndices(Eigen::Index size, Eigen::Index count, std::uint64_t seed);

}  // namespace batten
