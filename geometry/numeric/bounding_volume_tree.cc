// SPDX-License-Identifier: MIT
#include "geometry/numeric/bounding_volume_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "geometry/numeric/constants.h"
#include "geometry/numeric/run_time_dispatch.h"

namespace batten::internal {
namespace {

constexpr int kWide = 8;

// Cuts the boxes into up to eight groups of nearly equal size, each time halving the largest at the
// median of the longest side of its centres.
class Builder {
 public:
  Builder(const std::vector<Eigen::AlignedBox3d>& boxes,
          std::vector<BoundingVolumeTree::Node>& nodes)
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
      BoundingVolumeTree::Node& node = nodes_[index];
      node.child[lane] = child;
      for (int d = 0; d < 3; ++d) {
        node.low[d][lane] = hull.isEmpty() ? kInfinity : hull.min()[d];
        node.high[d][lane] = hull.isEmpty() ? kInfinity : hull.max()[d];
      }
    }
    return index;
  }

  const std::vector<Eigen::AlignedBox3d>& boxes_;
  std::vector<BoundingVolumeTree::Node>& nodes_;
  std::vector<int> order_;
};

typedef double Lanes __attribute__((vector_size(64), aligned(8)));

BATTEN_INLINE Lanes Load(const double* from) { return *reinterpret_cast<const Lanes*>(from); }
BATTEN_INLINE Lanes Greater(const Lanes& a, const Lanes& b) { return a > b ? a : b; }

// Depth first; children wait on a stack of at most seven a level.
BATTEN_CLONES
int Collect(const BoundingVolumeTree::Node* nodes,
            const double* q,
            double limit,
            BoundingVolumeTree::Near* found,
            int room,
            int* waiting,
            int* waiting_count) {
  const Lanes x = Lanes{} + q[0], y = Lanes{} + q[1], z = Lanes{} + q[2], zero{};
  int count = 0, left = *waiting_count;
  while (left > 0 && count + kWide <= room) {
    const BoundingVolumeTree::Node& node = nodes[waiting[--left]];
    const Lanes dx = Greater(Greater(Load(node.low[0]) - x, x - Load(node.high[0])), zero);
    const Lanes dy = Greater(Greater(Load(node.low[1]) - y, y - Load(node.high[1])), zero);
    const Lanes dz = Greater(Greater(Load(node.low[2]) - z, z - Load(node.high[2])), zero);
    const Lanes squared = dx * dx + dy * dy + dz * dz;
    for (int k = 0; k < kWide; ++k) {
      if (!(squared[k] <= limit)) continue;
      if (node.child[k] < 0) {
        found[count++] = {-1 - node.child[k], squared[k]};
      } else {
        waiting[left++] = node.child[k];
      }
    }
  }
  *waiting_count = left;
  return count;
}

}  // namespace

BoundingVolumeTree::BoundingVolumeTree(const std::vector<Eigen::AlignedBox3d>& boxes) {
  Builder(boxes, nodes_);
}

void BoundingVolumeTree::Within(const double* q, double squared, std::vector<Near>& found) const {
  if (nodes_.empty()) return;
  constexpr int kDeepest = kWide * 24, kBatch = 64;
  int waiting[kDeepest];
  int left = 1;
  waiting[0] = 0;
  Near batch[kBatch];
  while (left > 0) {
    const int count = Collect(nodes_.data(), q, squared, batch, kBatch, waiting, &left);
    found.insert(found.end(), batch, batch + count);
  }
}

}  // namespace batten::internal
