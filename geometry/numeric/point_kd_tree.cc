// SPDX-License-Identifier: MIT
#include "geometry/numeric/point_kd_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace batten::internal {
namespace {

constexpr int kLeaf = 8;

}  // namespace

PointKdTree::PointKdTree(const Eigen::Matrix3Xd& points) : order_(points.cols()) {
  std::iota(order_.begin(), order_.end(), 0);
  if (order_.empty()) return;
  low_ = points.rowwise().minCoeff();
  high_ = points.rowwise().maxCoeff();
  Build(points, 0, static_cast<int>(order_.size()));
  x_.reserve(order_.size());
  y_.reserve(order_.size());
  z_.reserve(order_.size());
  for (const int k : order_) {
    x_.push_back(points(0, k));
    y_.push_back(points(1, k));
    z_.push_back(points(2, k));
  }
}

int PointKdTree::Build(const Eigen::Matrix3Xd& points, int begin, int end) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  if (end - begin <= kLeaf) {
    nodes_[index].below = begin;
    nodes_[index].above = end;
    return index;
  }
  Eigen::Vector3d low = points.col(order_[begin]), high = low;
  for (int k = begin; k < end; ++k) {
    low = low.cwiseMin(points.col(order_[k]));
    high = high.cwiseMax(points.col(order_[k]));
  }
  Eigen::Index axis;
  (high - low).maxCoeff(&axis);
  const int middle = begin + (end - begin) / 2;
  std::nth_element(
      order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](int a, int b) {
        const double x = points(axis, a), y = points(axis, b);
        return x < y || (x == y && a < b);
      });
  const double cut = points(axis, order_[middle]);
  const int below = Build(points, begin, middle), above = Build(points, middle, end);
  nodes_[index] = {static_cast<int>(axis), cut, below, above};
  return index;
}

int PointKdTree::Nearest(const double* q, double limit) const {
  // A node, how far its points are from q along each axis at least, and squared in all: a little
  // less, so that rounding leaves out nothing.
  struct Wait {
    int node;
    double off[3], squared;
    void Sum() {
      constexpr double kLess = 1 - 8 * std::numeric_limits<double>::epsilon();
      squared = kLess * (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]);
    }
  };
  Wait waiting[64];
  int count = 0, best = -1;
  double nearest = limit;
  waiting[count++] = {0, {0, 0, 0}, 0};
  for (int d = 0; d < 3; ++d) {
    waiting[0].off[d] = std::max({0.0, low_[d] - q[d], q[d] - high_[d]});
  }
  waiting[0].Sum();
  while (count > 0) {
    const Wait next = waiting[--count];
    if (next.squared >= nearest) continue;
    int index = next.node;
    while (nodes_[index].axis >= 0) {
      const Node& node = nodes_[index];
      const double off = q[node.axis] - node.cut;
      Wait& other = waiting[count++] = next;
      other.node = off < 0 ? node.above : node.below;
      other.off[node.axis] = std::max(next.off[node.axis], std::abs(off));
      other.Sum();
      index = off < 0 ? node.below : node.above;
    }
    for (int k = nodes_[index].below; k < nodes_[index].above; ++k) {
      const double dx = x_[k] - q[0], dy = y_[k] - q[1], dz = z_[k] - q[2];
      const double squared = dx * dx + dy * dy + dz * dz;
      if (squared < nearest) {
        nearest = squared;
        best = k;
      }
    }
  }
  if (best >= 0) return order_[best];
  return std::isfinite(limit) ? -1 : order_.front();
}

}  // namespace batten::internal
