// SPDX-License-Identifier: MIT
#include "batten/fitting/cloud_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/statistics.h"

namespace batten {
namespace {

constexpr int kPartNeighbours = 16;
constexpr double kPartReach = 5;  // spacings: twice the radius of outlines' alpha shapes
constexpr double kPartCell = 2;   // spacings: what lies in touching cells is at most seven apart
constexpr Eigen::Index kLeastPartPoints = 30;
constexpr double kLeastPartShare = 1e-3;
constexpr std::ptrdiff_t kPartBlock = 4096;

class Sets {
 public:
  explicit Sets(Eigen::Index count) : parents_(static_cast<size_t>(count)) {
    std::iota(parents_.begin(), parents_.end(), Eigen::Index{0});
  }
  Eigen::Index Find(Eigen::Index k) {
    while (parents_[static_cast<size_t>(k)] != k) {
      Eigen::Index& parent = parents_[static_cast<size_t>(k)];
      parent = parents_[static_cast<size_t>(parent)];
      k = parent;
    }
    return k;
  }
  void Join(Eigen::Index a, Eigen::Index b) {
    a = Find(a);
    b = Find(b);
    parents_[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<Eigen::Index> parents_;
};

// The 16 nearest of every point, and the spacing around it: of so many points in their circle.
struct Neighbourhoods {
  std::vector<int> nearest;
  int each = 0;
  Eigen::VectorXd spacing;
};

Neighbourhoods NeighbourhoodsOf(const Eigen::Matrix3Xd& points, ThreadPool& pool) {
  const NeighbourIndex index(points, pool);
  Neighbourhoods around;
  around.each = static_cast<int>(std::min<Eigen::Index>(kPartNeighbours + 1, points.cols()));
  around.nearest.resize(static_cast<size_t>(points.cols()) * static_cast<size_t>(around.each));
  around.spacing.resize(points.cols());
  pool.For(points.cols(), kPartBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const std::vector<int> found =
        index.Nearest(points.middleCols(begin, end - begin), around.each);
    std::copy(found.begin(), found.end(), around.nearest.begin() + begin * around.each);
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const int last = around.nearest[static_cast<size_t>((k + 1) * around.each - 1)];
      const double radius = (points.col(last) - points.col(k)).norm();
      around.spacing[k] = radius * std::sqrt(std::numbers::pi / kPartNeighbours);
    }
  });
  return around;
}

void JoinNeighbours(const Eigen::Matrix3Xd& points,
                    const Neighbourhoods& around,
                    double spacing,
                    Sets& sets) {
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    for (int j = 1; j < around.each; ++j) {
      const Eigen::Index other = around.nearest[static_cast<size_t>(k * around.each + j)];
      const double reach =
          kPartReach * std::max(spacing, std::min(around.spacing[k], around.spacing[other]));
      if ((points.col(other) - points.col(k)).norm() <= reach) sets.Join(k, other);
    }
  }
}

// By their cells, in the order of x, y and z.
void JoinCells(const Eigen::Matrix3Xd& points, double side, Sets& sets) {
  using Cell = std::array<std::int64_t, 3>;
  const Eigen::Vector3d corner = points.rowwise().minCoeff();
  std::vector<std::pair<Cell, Eigen::Index>> firsts;
  firsts.reserve(static_cast<size_t>(points.cols()));
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const Eigen::Vector3d at = ((points.col(k) - corner) / side).array().floor();
    firsts.push_back({{static_cast<std::int64_t>(at[0]),
                       static_cast<std::int64_t>(at[1]),
                       static_cast<std::int64_t>(at[2])},
                      k});
  }
  std::sort(firsts.begin(), firsts.end());
  size_t kept = 0;
  for (const auto& one : firsts) {
    if (kept > 0 && firsts[kept - 1].first == one.first) {
      sets.Join(firsts[kept - 1].second, one.second);
    } else {
      firsts[kept++] = one;
    }
  }
  firsts.resize(kept);
  // The neighbours in a column of z follow one another.
  for (const auto& [cell, k] : firsts) {
    for (std::int64_t dx = -1; dx <= 0; ++dx) {
      for (std::int64_t dy = -1; dy <= (dx < 0 ? 1 : 0); ++dy) {
        const std::int64_t above = dx == 0 && dy == 0 ? cell[2] - 1 : cell[2] + 1;
        auto other = std::lower_bound(
            firsts.begin(),
            firsts.end(),
            std::pair(Cell{cell[0] + dx, cell[1] + dy, cell[2] - 1}, Eigen::Index{0}));
        for (; other != firsts.end() && other->first[0] == cell[0] + dx &&
               other->first[1] == cell[1] + dy && other->first[2] <= above;
             ++other) {
          sets.Join(k, other->second);
        }
      }
    }
  }
}

}  // namespace

CloudParts FindCloudParts(const PointCloud& cloud, ThreadPool& pool) {
  if (cloud.size() == 0) throw std::invalid_argument("FindCloudParts: cloud: holds no points");
  const MergedCloud merged = MergeDuplicates(cloud);
  const Eigen::Matrix3Xd& points = merged.cloud.points();
  Sets sets(points.cols());
  const Neighbourhoods around = NeighbourhoodsOf(points, pool);
  const double spacing = Median(std::vector<double>(around.spacing.begin(), around.spacing.end()));
  JoinNeighbours(points, around, spacing, sets);
  // Cells are numbered by 64 bits.
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
  constexpr double kMostPartCells = 0x1p60;
  if (spacing > 0 && size < kMostPartCells * kPartCell * spacing)
    JoinCells(points, kPartCell * spacing, sets);

  std::vector<std::vector<Eigen::Index>> members(static_cast<size_t>(points.cols()));
  for (Eigen::Index k = 0; k < cloud.size(); ++k)
    members[static_cast<size_t>(sets.Find(merged.place[static_cast<size_t>(k)]))].push_back(k);
  CloudParts found;
  const auto all = static_cast<double>(cloud.size());
  for (std::vector<Eigen::Index>& one : members) {
    const auto count = std::ssize(one);
    if (count == 0) continue;
    if (count < kLeastPartPoints || static_cast<double>(count) < kLeastPartShare * all) {
      found.stray += count;
      continue;
    }
    CloudPart part;
    for (const Eigen::Index k : one) part.box.extend(cloud.World(k));
    part.share = static_cast<double>(count) / all;
    part.points = std::move(one);
    found.parts.push_back(std::move(part));
  }
  std::stable_sort(
      found.parts.begin(), found.parts.end(), [](const CloudPart& a, const CloudPart& b) {
        return a.points.size() > b.points.size();
      });
  return found;
}

}  // namespace batten
