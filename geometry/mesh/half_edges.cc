// SPDX-License-Identifier: MIT
#include "geometry/mesh/half_edges.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace batten::internal {
namespace {

// Numbers below `count` by their keys, equal keys in order: those of key g are items[begin[g]] and
// on.
struct Groups {
  std::vector<int> begin, items;
};

template <typename Key>
Groups GroupBy(int count, int keys, const Key& key) {
  Groups groups{std::vector<int>(static_cast<std::size_t>(keys) + 1),
                std::vector<int>(static_cast<std::size_t>(count))};
  for (int i = 0; i < count; ++i) ++groups.begin[static_cast<std::size_t>(key(i)) + 1];
  for (std::size_t g = 0; g < static_cast<std::size_t>(keys); ++g)
    groups.begin[g + 1] += groups.begin[g];
  std::vector<int> next(groups.begin.begin(), groups.begin.end() - 1);
  for (int i = 0; i < count; ++i)
    groups.items[static_cast<std::size_t>(next[static_cast<std::size_t>(key(i))]++)] = i;
  return groups;
}

}  // namespace

HalfEdges LinkTriangles(const Eigen::Ref<const Eigen::Matrix3Xi>& triangles, int vertices) {
  const int count = 3 * static_cast<int>(triangles.cols());
  const auto ends = [&](int h) {
    return std::minmax({triangles(h % 3, h / 3), triangles((h + 1) % 3, h / 3)});
  };
  const Groups groups = GroupBy(count, vertices, [&](int h) { return ends(h).first; });
  HalfEdges edges{std::vector<int>(static_cast<std::size_t>(count), -1), {}};
  std::vector<std::pair<int, int>> about;  // the farther ends about a vertex, and the half-edges
  for (std::size_t v = 0; v + 1 < groups.begin.size(); ++v) {
    about.clear();
    for (int i = groups.begin[v]; i < groups.begin[v + 1]; ++i) {
      const int h = groups.items[static_cast<std::size_t>(i)];
      about.emplace_back(ends(h).second, h);
    }
    std::sort(about.begin(), about.end());
    for (std::size_t first = 0, last; first < about.size(); first = last) {
      for (last = first + 1; last < about.size() && about[last].first == about[first].first;)
        ++last;
      if (last - first == 2) {
        edges.twin[static_cast<std::size_t>(about[first].second)] = about[first + 1].second;
        edges.twin[static_cast<std::size_t>(about[first + 1].second)] = about[first].second;
      } else if (last - first > 2) {
        std::vector<int>& all = edges.crowded.emplace_back();
        for (std::size_t k = first; k < last; ++k) all.push_back(about[k].second);
      }
    }
  }
  return edges;
}

std::vector<bool> RepeatedTriangles(const Eigen::Ref<const Eigen::Matrix3Xi>& triangles,
                                    int vertices) {
  const int count = static_cast<int>(triangles.cols());
  const Groups groups =
      GroupBy(count, vertices, [&](int t) { return triangles.col(t).minCoeff(); });
  std::vector<bool> repeated(static_cast<std::size_t>(count));
  std::vector<std::array<int, 3>> about;  // the two farther corners, and the triangle
  for (std::size_t v = 0; v + 1 < groups.begin.size(); ++v) {
    about.clear();
    for (int i = groups.begin[v]; i < groups.begin[v + 1]; ++i) {
      const int t = groups.items[static_cast<std::size_t>(i)];
      std::array<int, 3> corners = {triangles(0, t), triangles(1, t), triangles(2, t)};
      std::sort(corners.begin(), corners.end());
      about.push_back({corners[1], corners[2], t});
    }
    std::sort(about.begin(), about.end());
    for (std::size_t k = 1; k < about.size(); ++k) {
      if (about[k][0] == about[k - 1][0] && about[k][1] == about[k - 1][1])
        repeated[static_cast<std::size_t>(about[k][2])] = true;
    }
  }
  return repeated;
}

}  // namespace batten::internal
