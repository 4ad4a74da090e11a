// SPDX-License-Identifier: MIT
#include "batten/fitting/neighbours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "fitting/neighbours/nearest_kernel.h"
#include "fitting/neighbours/spatial_sort.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kLeaf = NearestTree::kLeaf, kFan = NearestTree::kFan;
constexpr std::ptrdiff_t kLeavesPerBlock = 256;
constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr float kMostLocal = 1e18F;  // whose square is finite

}  // namespace

struct NeighbourIndex::Tree {
  Eigen::Vector3d centre;
  double scale;  // a power of two that brings coordinates near one: floats reach from 1e-38 to 1e38
                 // only
  std::vector<float> leaves;
  std::vector<int> ids;
  std::vector<std::vector<float>> boxes;
  Eigen::Index size = 0;
  NearestTree view;

  float Local(double world, int d) const { return static_cast<float>((world - centre[d]) * scale); }

  void Halve(const Eigen::Matrix3Xd& points, ThreadPool& pool);
  void Enclose(ThreadPool& pool);
};

// Sorts the points into leaves.
void NeighbourIndex::Tree::Halve(const Eigen::Matrix3Xd& points, ThreadPool& pool) {
  size = points.cols();
  std::vector<PlacedPoint> placed(static_cast<size_t>(size));
  pool.For(size, kLeavesPerBlock * kLeaf, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      PlacedPoint& p = placed[static_cast<size_t>(k)];
      for (int d = 0; d < 3; ++d) p.at[d] = Local(points(d, k), d);
      p.id = static_cast<int>(k);
    }
  });
  HalveDownTo(placed, kLeaf, pool);
  const std::ptrdiff_t count = (size + kLeaf - 1) / kLeaf;
  leaves.resize(static_cast<size_t>(count) * 3 * kLeaf);
  ids.resize(static_cast<size_t>(count) * kLeaf);
  pool.For(count, kLeavesPerBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin * kLeaf; k < end * kLeaf; ++k) {
      float* at = leaves.data() + k / kLeaf * 3 * kLeaf + k % kLeaf;
      const bool there = k < size;
      for (int d = 0; d < 3; ++d)
        at[d * kLeaf] = there ? placed[static_cast<size_t>(k)].at[d] : kFar;
      ids[static_cast<size_t>(k)] = there ? placed[static_cast<size_t>(k)].id : -1;
    }
  });
}

// Computes the bounding boxes, level by level.
void NeighbourIndex::Tree::Enclose(ThreadPool& pool) {
  std::ptrdiff_t below = std::ssize(ids) / kLeaf;
  do {
    const std::ptrdiff_t groups = (below + kFan - 1) / kFan;
    const float* lower = boxes.empty() ? nullptr : boxes.back().data();
    std::vector<float> level(static_cast<size_t>(groups) * 6 * kFan);
    pool.For(groups, kLeavesPerBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t i = begin * kFan; i < end * kFan; ++i) {
        for (int d = 0; d < 3; ++d) {
          float low = kFar, high = -kFar;
          if (i < below && lower == nullptr) {
            const float* of = leaves.data() + (i * 3 + d) * kLeaf;
            const std::ptrdiff_t here = std::min<std::ptrdiff_t>(kLeaf, size - i * kLeaf);
            for (std::ptrdiff_t j = 0; j < here; ++j) {
              low = std::min(low, of[j]);
              high = std::max(high, of[j]);
            }
          } else if (i < below) {
            const float* of = lower + i * 6 * kFan;
            low = *std::min_element(of + d * kFan, of + (d + 1) * kFan);
            high = *std::max_element(of + (3 + d) * kFan, of + (4 + d) * kFan);
          }
          float* at = level.data() + i / kFan * 6 * kFan + i % kFan;
          at[d * kFan] = low;
          at[(3 + d) * kFan] = high;
        }
      }
    });
    boxes.push_back(std::move(level));
    below = groups;
  } while (below > 1);
  view.leaves = leaves.data();
  view.ids = ids.data();
  view.levels = static_cast<int>(boxes.size());
  for (size_t i = 0; i < boxes.size(); ++i) view.boxes[i] = boxes[i].data();
}

NeighbourIndex::NeighbourIndex(const Eigen::Matrix3Xd& points, ThreadPool& pool)
    : tree_(std::make_unique<Tree>()) {
  if (points.cols() == 0) throw std::invalid_argument("NeighbourIndex: no points");
  const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  tree_->centre = low / 2 + high / 2;
  const double reach = (high - tree_->centre).maxCoeff();
  tree_->scale = reach > 0 ? std::exp2(std::clamp(-std::ilogb(reach), -1000, 1000)) : 1;
  tree_->Halve(points, pool);
  tree_->Enclose(pool);
}

NeighbourIndex::NeighbourIndex(const Eigen::Matrix3Xd& points) : tree_() {
  ThreadPool alone(1);
  *this = NeighbourIndex(points, alone);
}

NeighbourIndex::~NeighbourIndex() = default;
NeighbourIndex::NeighbourIndex(NeighbourIndex&&) noexcept = default;
NeighbourIndex& NeighbourIndex::operator=(NeighbourIndex&&) noexcept = default;

Eigen::Index NeighbourIndex::size() const { return tree_->size; }

std::span<const int> NeighbourIndex::order() const {
  return {tree_->ids.data(), static_cast<size_t>(tree_->size)};
}

std::vector<int> NeighbourIndex::Nearest(const Eigen::Matrix3Xd& queries, int k) const {
  k = static_cast<int>(std::clamp<Eigen::Index>(k, 0, size()));
  std::vector<int> indices(static_cast<size_t>(queries.cols()) * static_cast<size_t>(k));
  if (k == 0) return indices;
  const size_t most = 2 * static_cast<size_t>(k) + 64;
  std::vector<float> squares(most);
  std::vector<int> ids(most);
  std::vector<double> keys(most);
  const NearestRoom room{squares.data(), ids.data(), keys.data()};
  for (Eigen::Index i = 0; i < queries.cols(); ++i) {
    float q[3];
    for (int d = 0; d < 3; ++d)
      q[d] = std::clamp(tree_->Local(queries(d, i), d), -kMostLocal, kMostLocal);
    NearestInTree(tree_->view, q, k, room, indices.data() + i * k);
  }
  return indices;
}

}  // namespace batten
