// SPDX-License-Identifier: MIT
// Perfect matchings of graphs.
#pragma once

#include <array>
#include <vector>

namespace batten::internal {

// The edges of a perfect matching of greatest weight, ascending; none if there is no perfect one.
// O(n m log n). [Edmonds 1965; LEMON's implementation]
std::vector<int> PerfectMatching(int nodes,
                                 const std::vector<std::array<int, 2>>& edges,
                                 const std::vector<int>& weights);

}  // namespace batten::internal
