// SPDX-License-Identifier: MIT
// The four corners of a sheet's border.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "fitting/flattening/poisson_disk_samples.h"

namespace batten::internal {

struct BorderCorners {
  std::array<size_t, 4> at{};  // places in the loop, ascending
  std::string failure_reason;  // empty where there are exactly four

  bool ok() const { return failure_reason.empty(); }
};

// Finds the corners of a border, a closed loop of nodes with the sheet on its left. Its turning at
// a node is the angle, in the node's tangent plane, between the chords to the node and from it, by
// two lengths of chords the smaller one: notches of single nodes do not count, nor what turns on
// one side only. There are four corners where the fourth largest turning is clear of the fifth;
// turnings of neighbours count once. Chords are no longer than half of `width`, the sheet's. O(n).
BorderCorners FourCornersOf(const PoissonDiskSamples& nodes,
                            const std::vector<int>& loop,
                            double width);

}  // namespace batten::internal
