// SPDX-License-Identifier: MIT
// A mask marks some of a cloud's points; a sample draws some of them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace batten {

using PointMask = Eigen::Array<bool, Eigen::Dynamic, 1>;

// `count` different indices of [0, size), in increasing order; all of them when count ≥ size.
std::vector<Eigen::Index> SampleIndices(Eigen::Index size, Eigen::Index count, std::uint64_t seed);

}  // namespace batten
