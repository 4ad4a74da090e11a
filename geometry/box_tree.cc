// SPDX-License-Identifier: MIT
#include "batten/geometry/box_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "batten/geometry/run_time_dispatch.h"

namespace batten {
namespace {

constexpr int kWide = 8;

// Cuts the boxes into up to eight groups of nearly equal size, each time halving the largest at the
// median of the longest side of its centres.
class Builder {
 public:
  Builder(const std::vector<Eigen::AlignedBox3d>& boxes, std::vector<BoxTree::Node>& nodes)
      : boxes_(boxes), nodes_(nodes), order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    if (!boxes_.empty()) Build(0, static_cast<int>(boxes_.size()));
  }

 private:
  struct Range {
    int begin, end;
  };

  int Halve(const Range& range) {
    Eigen::AlignedBox3d centres;
    for (int k = range.begin; k < range.end; ++k) centres.extend(boxes_[order_[k]].center());
    Eigen::Index axis;
    centres.sizes().maxCoeff(&axis);
    const int middle = range.begin + (range.end - range.begin) / 2;
    std::nth_element(order_.begin() + range.begin,
                     order_.begin() + middle,
                     order_.begin() + range.end,
                     [&](int a, int b) {
                       const double x = boxes_[a].center()[axis], y = boxes_[b].center()[axis];
                       return x < y || (x == y && a < b);
                     });
    return middle;
  }

  int Build(int begin, int end) {
    std::vector<Range> groups{{begin, end}};
    while (static_cast<int>(groups.size()) < kWide) {
      const auto largest =
          std::max_element(groups.begin(), groups.end(), [](const Range& a, const Range& b) {
            return a.end - a.begin < b.end - b.begin;
          });
      if (largest->end - largest->begin < 2) break;
      const int middle = Halve(*largest), last = largest->end;
      largest->end = middle;
      groups.insert(largest + 1, {middle, last});
    }
    const int index = static_cast<int>(nodes_.size());
    nodes_.emplace_back();
    for (int lane = 0; lane < kWide; ++lane) {
      Eigen::AlignedBox3d hull;
      int child = 0;
      if (lane < static_cast<int>(groups.size())) {
        const Range group = groups[lane];
        for (int k = group.begin; k < group.end; ++k) hull.extend(boxes_[order_[k]]);
        child =
            group.end - group.begin == 1 ? -1 - order_[group.begin] : Build(group.begin, group.end);
      }
      BoxTree::Node& node = nodes_[index];
      node.child[lane] = child;
      for (int d = 0; d < 3; ++d) {
        constexpr double kNowhere = std::numeric_limits<double>::infinity();
        node.low[d][lane] = hull.isEmpty() ? kNowhere : hull.min()[d];
        node.high[d][lane] = hull.isEmpty() ? kNowhere : hull.max()[d];
      }
    }
    return index;
  }

  const std::vector<Eigen::AlignedBox3d>& boxes_;
  std::vector<BoxTree::Node>& nodes_;
  std::vector<int> order_;
};

BATTEN_CLONES
void SquaredDistances(const BoxTree::Node& node, const double* q, double* squared) {
  for (int k = 0; k < kWide; ++k) squared[k] = 0;
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k < kWide; ++k) {
      const double below = node.low[d][k] - q[d], above = q[d] - node.high[d][k];
      const double outside = below > above ? below : above;
      const double off = outside > 0 ? outside : 0;
      squared[k] += off * off;
    }
  }
}

}  // namespace

BoxTree::BoxTree(const std::vector<Eigen::AlignedBox3d>& boxes) { Builder(boxes, nodes_); }

void BoxTree::Within(const double* q, double squared, std::vector<Near>& found) const {
  if (nodes_.empty()) return;
  constexpr int kDeepest = 8 * 24;  // eight children a level, of which seven wait
  int waiting[kDeepest];
  int count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const Node& node = nodes_[waiting[--count]];
    double distances[kWide];
    SquaredDistances(node, q, distances);
    for (int k = 0; k < kWide; ++k) {
      if (!(distances[k] <= squared)) continue;
      if (node.child[k] < 0) {
        found.push_back({-1 - node.child[k], distances[k]});
      } else {
        waiting[count++] = node.child[k];
      }
    }
  }
}

}  // namespace batten
