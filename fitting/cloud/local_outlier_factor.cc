// SPDX-License-Identifier: MIT
#include "fitting/cloud/local_outlier_factor.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "batten/fitting/neighbours.h"

namespace batten::internal {
namespace {

constexpr int kNeighbour = 6;
constexpr double kMuchFarther = 2.5;
constexpr int kCountedByFew = 1;
constexpr Eigen::Index kFewest = 50;

// The sixth neighbours' distances and the six neighbours of every point of an index, by the index's
// order.
struct Circles {
  std::vector<int> neighbours;  // ranks in the order
  std::vector<double> reach;
};

Circles CirclesOf(const Eigen::Matrix3Xd& points, const NeighbourIndex& index, ThreadPool& pool) {
  const auto order = index.order();
  const auto count = std::ssize(order);
  std::vector<int> rank(order.size());
  for (std::ptrdiff_t i = 0; i < count; ++i)
    rank[static_cast<size_t>(order[i])] = static_cast<int>(i);
  Circles circles{std::vector<int>(order.size() * kNeighbour), std::vector<double>(order.size())};
  pool.For(count, 512, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    Eigen::Matrix3Xd queries(3, end - begin);
    for (auto i = begin; i < end; ++i) queries.col(i - begin) = points.col(order[i]);
    const std::vector<int> near = index.Nearest(queries, kNeighbour + 1);  // the point itself first
    for (auto i = begin; i < end; ++i) {
      const int* row = near.data() + (i - begin) * (kNeighbour + 1) + 1;
      for (int n = 0; n < kNeighbour; ++n)
        circles.neighbours[static_cast<size_t>(i * kNeighbour + n)] =
            rank[static_cast<size_t>(row[n])];
      circles.reach[static_cast<size_t>(i)] =
          (points.col(row[kNeighbour - 1]) - queries.col(i - begin)).norm();
    }
  });
  return circles;
}

bool StandsApart(const Circles& circles, std::ptrdiff_t i) {
  std::array<double, kNeighbour> theirs;
  for (int n = 0; n < kNeighbour; ++n)
    theirs[n] = circles.reach[static_cast<size_t>(circles.neighbours[i * kNeighbour + n])];
  std::sort(theirs.begin(), theirs.end());
  const double median = (theirs[kNeighbour / 2 - 1] + theirs[kNeighbour / 2]) / 2;
  return circles.reach[static_cast<size_t>(i)] > kMuchFarther * median;
}

}  // namespace

PointMask NonIsolatedPoints(const Eigen::Matrix3Xd& points,
                            const PointMask& mask,
                            ThreadPool& pool) {
  PointMask company = mask;
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index k = 0; k < mask.size(); ++k) {
    if (mask[k]) chosen.push_back(k);
  }
  const auto count = std::ssize(chosen);
  if (count < kFewest) return company;
  const Eigen::Matrix3Xd some = points(Eigen::all, chosen);
  const NeighbourIndex index(some, pool);
  const Circles circles = CirclesOf(some, index, pool);
  std::vector<char> apart(chosen.size());
  pool.For(count, 4096, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto i = begin; i < end; ++i)
      apart[static_cast<size_t>(i)] = StandsApart(circles, i) ? 1 : 0;
  });
  // Where the density drops across a line, points on its sparse side are counted by sparse ones.
  std::vector<int> counted_by(chosen.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    if (apart[static_cast<size_t>(i)]) continue;
    for (int n = 0; n < kNeighbour; ++n)
      ++counted_by[static_cast<size_t>(circles.neighbours[i * kNeighbour + n])];
  }
  const auto order = index.order();
  for (size_t i = 0; i < chosen.size(); ++i) {
    if (apart[i] && counted_by[i] <= kCountedByFew)
      company[chosen[static_cast<size_t>(order[i])]] = false;
  }
  return company;
}

PointMask NonIsolatedPoints(const Eigen::Matrix3Xd& points, const PointMask& mask) {
  ThreadPool alone(1);
  return NonIsolatedPoints(points, mask, alone);
}

}  // namespace batten::internal
