// SPDX-License-Identifier: MIT
#include "fitting/flattening/flag_complex.h"

#include <algorithm>
#include <complex>

namespace batten::internal {

FlagComplex::FlagComplex(std::size_t nodes, const std::vector<PlanarEdge>& edges)
    : next(nodes), around(edges.size()) {
  for (size_t e = 0; e < edges.size(); ++e) {
    next[edges[e].first].push_back({edges[e].second, static_cast<int>(e)});
    next[edges[e].second].push_back({edges[e].first, static_cast<int>(e)});
    lengths.push_back(std::abs(edges[e].from_first));
  }
  for (auto& list : next) std::sort(list.begin(), list.end());
  for (size_t e = 0; e < edges.size(); ++e) {
    const int a = edges[e].first, b = edges[e].second;
    auto i = next[a].begin(), j = next[b].begin();
    while (i != next[a].end() && j != next[b].end()) {
      if (i->first != j->first) {
        ++(i->first < j->first ? i : j);
        continue;
      }
      if (i->first > b) {
        const auto triangle = static_cast<int>(triangles.size());
        triangles.push_back({static_cast<int>(e), j->second, i->second});
        for (const int edge : triangles.back()) around[edge].push_back(triangle);
      }
      ++i;
      ++j;
    }
  }
}

}  // namespace batten::internal
