// SPDX-License-Identifier: MIT
#include "fitting/cloud/connected_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>

#include "batten/fitting/statistics.h"
#include "fitting/cloud/cloud_constants.h"
#include "fitting/core/mask_indices.h"
#include "fitting/core/shared_constants.h"
#include "fitting/neighbours/signed_sets.h"

namespace batten::internal {
namespace {

constexpr int kPartNeighbours = 16;
constexpr double kPartReach = 5;    // spacings: twice the radius of outlines' alpha shapes
constexpr double kPartCell = 2;     // spacings: what lies in touching cells is at most seven apart
constexpr double kMostOfAll = 0.8;  // a part of so many of the others has clutter beside it …
constexpr double kOfTheLargest = 0.1;  // … in parts of at most so many of its points

// By their cells, in the order of x, y and z.
void JoinCells(const Eigen::Matrix3Xd& points, double side, SignedSets& sets) {
  using Cell = std::array<std::int64_t, 3>;
  const Eigen::Vector3d corner = points.rowwise().minCoeff();
  std::vector<std::pair<Cell, int>> firsts;
  firsts.reserve(static_cast<size_t>(points.cols()));
  for (int k = 0; k < points.cols(); ++k) {
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
        auto other = std::lower_bound(firsts.begin(),
                                      firsts.end(),
                                      std::pair(Cell{cell[0] + dx, cell[1] + dy, cell[2] - 1}, 0));
        for (; other != firsts.end() && other->first[0] == cell[0] + dx &&
               other->first[1] == cell[1] + dy && other->first[2] <= above;
             ++other) {
          sets.Join(k, other->second);
        }
      }
    }
  }
}

// The nearest of some points, and the spacing around each: of so many points in their circle.
struct Neighbourhoods {
  std::vector<int> nearest;  // `each` a point
  int each = 0;
  Eigen::VectorXd spacing;
};

Neighbourhoods NeighbourhoodsOf(const Eigen::Matrix3Xd& points,
                                const std::vector<Eigen::Index>& some,
                                const NeighbourIndex& index,
                                ThreadPool& pool) {
  Neighbourhoods around;
  const auto count = std::ssize(some);
  around.each = static_cast<int>(std::min<Eigen::Index>(kPartNeighbours + 1, points.cols()));
  around.nearest.resize(static_cast<size_t>(count) * static_cast<size_t>(around.each));
  around.spacing.resize(count);
  pool.For(count, kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const std::span asked(some.begin() + begin, some.begin() + end);
    const std::vector<int> found = index.Nearest(points(Eigen::all, asked), around.each);
    std::copy(found.begin(), found.end(), around.nearest.begin() + begin * around.each);
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const int last = around.nearest[static_cast<size_t>((k + 1) * around.each - 1)];
      const double radius = (points.col(last) - points.col(asked[k - begin])).norm();
      around.spacing[k] = radius * std::sqrt(std::numbers::pi / kPartNeighbours);
    }
  });
  return around;
}

double SpacingOf(const Eigen::Matrix3Xd& points, const NeighbourIndex& index, ThreadPool& pool) {
  std::vector<Eigen::Index> sample;
  const Eigen::Index count = points.cols(), wanted = std::min(count, kTypical);
  for (Eigen::Index k = 0; k < wanted; ++k) sample.push_back(k * count / wanted);
  const Neighbourhoods around = NeighbourhoodsOf(points, sample, index, pool);
  return Median(std::vector<double>(around.spacing.begin(), around.spacing.end()));
}

// The root of the largest set, and its size.
std::pair<Eigen::Index, Eigen::Index> Largest(const std::vector<Eigen::Index>& roots) {
  std::vector<Eigen::Index> sizes(roots.size());
  for (const Eigen::Index root : roots) ++sizes[static_cast<size_t>(root)];
  const auto most = std::max_element(sizes.begin(), sizes.end());
  return {most - sizes.begin(), *most};
}

// The least index of each one's set.
std::vector<Eigen::Index> RootsOf(SignedSets& sets, int count) {
  std::vector<Eigen::Index> firsts(static_cast<size_t>(count), -1), roots;
  roots.reserve(static_cast<size_t>(count));
  for (int k = 0; k < count; ++k) {
    Eigen::Index& first = firsts[static_cast<size_t>(sets.Find(k).first)];
    roots.push_back(first < 0 ? first = k : first);
  }
  return roots;
}

// Some points and their neighbours, ascending.
std::vector<Eigen::Index> WithNeighbours(std::vector<Eigen::Index> some,
                                         const Neighbourhoods& around) {
  some.insert(some.end(), around.nearest.begin(), around.nearest.end());
  std::sort(some.begin(), some.end());
  some.erase(std::unique(some.begin(), some.end()), some.end());
  return some;
}

// Joins those of some points that are among one another's neighbours, within reach: a stray point
// is none of the neighbours of its nearest ones.
void JoinNeighbours(const Eigen::Matrix3Xd& points,
                    const std::vector<Eigen::Index>& some,
                    const Neighbourhoods& around,
                    double spacing,
                    SignedSets& sets) {
  std::vector<std::ptrdiff_t> rows(static_cast<size_t>(points.cols()), -1);
  for (std::ptrdiff_t i = 0; i < std::ssize(some); ++i)
    rows[static_cast<size_t>(some[static_cast<size_t>(i)])] = i;
  const auto neighbours = [&](std::ptrdiff_t row) {
    return std::span(around.nearest)
        .subspan(static_cast<size_t>(row * around.each), static_cast<size_t>(around.each));
  };
  for (std::ptrdiff_t i = 0; i < std::ssize(some); ++i) {
    const Eigen::Index k = some[static_cast<size_t>(i)];
    for (const int other : neighbours(i)) {
      const std::ptrdiff_t row = rows[static_cast<size_t>(other)];
      if (row < 0 || std::ranges::find(neighbours(row), k) == neighbours(row).end()) continue;
      const double reach =
          kPartReach * std::max(spacing, std::min(around.spacing[i], around.spacing[row]));
      if ((points.col(other) - points.col(k)).norm() <= reach)
        sets.Join(static_cast<int>(k), other);
    }
  }
}

}  // namespace

std::vector<Eigen::Index> ConnectedPoints(const Eigen::Matrix3Xd& points,
                                          const NeighbourIndex& index,
                                          ThreadPool& pool) {
  const auto count = static_cast<int>(points.cols());
  SignedSets sets(count);
  const double spacing = SpacingOf(points, index, pool);
  // Cells are numbered by 64 bits.
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
  if (spacing > 0 && size < 0x1p60 * kPartCell * spacing)
    JoinCells(points, kPartCell * spacing, sets);
  std::vector<Eigen::Index> roots = RootsOf(sets, count);
  const Eigen::Index largest = Largest(roots).first;
  std::vector<Eigen::Index> outside;
  for (Eigen::Index k = 0; k < count; ++k)
    if (roots[static_cast<size_t>(k)] != largest) outside.push_back(k);
  if (outside.empty()) return roots;
  outside = WithNeighbours(outside, NeighbourhoodsOf(points, outside, index, pool));
  JoinNeighbours(points, outside, NeighbourhoodsOf(points, outside, index, pool), spacing, sets);
  return RootsOf(sets, count);
}

std::vector<int> SmallParts(const Eigen::Matrix3Xd& points,
                            const PointMask& mask,
                            ThreadPool& pool) {
  const std::vector<Eigen::Index> some = IndicesOf(mask);
  if (some.empty()) return {};
  const Eigen::Matrix3Xd own = points(Eigen::all, some);
  const std::vector<Eigen::Index> roots = ConnectedPoints(own, NeighbourIndex(own, pool), pool);
  const auto most = static_cast<double>(Largest(roots).second);
  std::vector<Eigen::Index> sizes(roots.size());
  for (const Eigen::Index root : roots) ++sizes[static_cast<size_t>(root)];
  double in_parts = 0;
  for (const Eigen::Index size : sizes)
    if (size >= kLeastPartPoints) in_parts += static_cast<double>(size);
  if (most < kMostOfAll * in_parts) return {};
  std::vector<int> number(roots.size(), -1), parts(static_cast<size_t>(points.cols()), -1);
  int count = 0;
  for (size_t i = 0; i < roots.size(); ++i) {
    const auto root = static_cast<size_t>(roots[i]);
    if (sizes[root] < kLeastPartPoints || static_cast<double>(sizes[root]) > kOfTheLargest * most)
      continue;
    if (number[root] < 0) number[root] = count++;
    parts[static_cast<size_t>(some[i])] = number[root];
  }
  return count > 0 ? parts : std::vector<int>{};
}

}  // namespace batten::internal
