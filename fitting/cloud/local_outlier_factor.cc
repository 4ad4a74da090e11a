// SPDX-License-Identifier: MIT
#include "fitting/cloud/local_outlier_factor.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "fitting/cloud/cloud_constants.h"
#include "fitting/cloud/connected_points.h"
#include "fitting/core/mask_indices.h"

namespace batten::internal {
namespace {

constexpr double kMuchFarther = 2.5;
// A stray beside an edge: its second neighbour so many times as far as that, and all on one side,
// by the mean of their directions (0.64 along a straight edge).
constexpr double kFarFromAll = 1.15, kOnOneSide = 0.8;
constexpr int kCountedByFew = 1;
constexpr Eigen::Index kFewest = 50;

// The sixth neighbours' distances and the six neighbours of every point of an index, by the index's
// order.
struct Circles {
  std::vector<int> neighbours;        // ranks in the order
  std::vector<double> reach, second;  // distances of the last and of the second of them
  std::vector<double> lean;           // length of the mean of their directions
};

Circles CirclesOf(const Eigen::Matrix3Xd& points, const NeighbourIndex& index, ThreadPool& pool) {
  const auto order = index.order();
  const auto count = std::ssize(order);
  std::vector<int> rank(order.size());
  for (std::ptrdiff_t i = 0; i < count; ++i)
    rank[static_cast<size_t>(order[i])] = static_cast<int>(i);
  Circles circles{std::vector<int>(order.size() * kReachNeighbour),
                  std::vector<double>(order.size()),
                  std::vector<double>(order.size()),
                  std::vector<double>(order.size())};
  pool.For(count, 512, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const Eigen::Matrix3Xd queries =
        points(Eigen::all, std::span(order.begin() + begin, order.begin() + end));
    const std::vector<int> near =
        index.Nearest(queries, kReachNeighbour + 1);  // the point itself first
    for (auto i = begin; i < end; ++i) {
      const int* row = near.data() + (i - begin) * (kReachNeighbour + 1) + 1;
      for (int n = 0; n < kReachNeighbour; ++n)
        circles.neighbours[static_cast<size_t>(i * kReachNeighbour + n)] =
            rank[static_cast<size_t>(row[n])];
      circles.reach[static_cast<size_t>(i)] =
          (points.col(row[kReachNeighbour - 1]) - queries.col(i - begin)).norm();
      Eigen::Vector3d lean = Eigen::Vector3d::Zero();
      for (int n = 0; n < kReachNeighbour; ++n)
        lean += (points.col(row[n]) - queries.col(i - begin)).stableNormalized() / kReachNeighbour;
      circles.lean[static_cast<size_t>(i)] = lean.norm();
      circles.second[static_cast<size_t>(i)] = (points.col(row[1]) - queries.col(i - begin)).norm();
    }
  });
  return circles;
}

// How a point stands among its neighbours.
enum class Standing : char { kAmong, kBeside, kApart };

Standing StandingOf(const Circles& circles, std::ptrdiff_t i) {
  std::array<double, kReachNeighbour> theirs;
  for (int n = 0; n < kReachNeighbour; ++n)
    theirs[n] = circles.reach[static_cast<size_t>(circles.neighbours[i * kReachNeighbour + n])];
  std::sort(theirs.begin(), theirs.end());
  const double median = (theirs[kReachNeighbour / 2 - 1] + theirs[kReachNeighbour / 2]) / 2;
  if (circles.reach[static_cast<size_t>(i)] > kMuchFarther * median) return Standing::kApart;
  const bool beside = circles.second[static_cast<size_t>(i)] > kFarFromAll * median &&
                      circles.lean[static_cast<size_t>(i)] > kOnOneSide;
  return beside ? Standing::kBeside : Standing::kAmong;
}

// Strays are far from all others, or from all but a few strays like them.
void LeaveOutGroups(const Eigen::Matrix3Xd& points, PointMask& mask, ThreadPool& pool) {
  const std::vector<Eigen::Index> some = IndicesOf(mask);
  const Eigen::Matrix3Xd own = points(Eigen::all, some);
  const std::vector<Eigen::Index> roots = ConnectedPoints(own, NeighbourIndex(own, pool), pool);
  std::vector<Eigen::Index> sizes(roots.size());
  for (const Eigen::Index root : roots) ++sizes[static_cast<size_t>(root)];
  const double least =
      std::max<double>(kLeastPartPoints, kLeastPartShare * static_cast<double>(some.size()));
  if (static_cast<double>(*std::ranges::max_element(sizes)) < least) return;  // nothing but strays
  for (size_t i = 0; i < some.size(); ++i)
    mask[some[i]] = static_cast<double>(sizes[static_cast<size_t>(roots[i])]) >= least;
}

}  // namespace

PointMask NonIsolatedPoints(const Eigen::Matrix3Xd& points,
                            const PointMask& mask,
                            ThreadPool& pool,
                            bool many_strays) {
  PointMask company = mask;
  const std::vector<Eigen::Index> chosen = IndicesOf(mask);
  const auto count = std::ssize(chosen);
  if (count < kFewest) return company;
  const Eigen::Matrix3Xd some = points(Eigen::all, chosen);
  const NeighbourIndex index(some, pool);
  const Circles circles = CirclesOf(some, index, pool);
  std::vector<Standing> standing(chosen.size());
  pool.For(count, 4096, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto i = begin; i < end; ++i) standing[static_cast<size_t>(i)] = StandingOf(circles, i);
  });
  // Where the density drops across a line, points on its sparse side are counted by sparse ones.
  std::vector<int> counted_by(chosen.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    if (standing[static_cast<size_t>(i)] != Standing::kAmong) continue;
    for (int n = 0; n < kReachNeighbour; ++n)
      ++counted_by[static_cast<size_t>(circles.neighbours[i * kReachNeighbour + n])];
  }
  const auto order = index.order();
  for (size_t i = 0; i < chosen.size(); ++i) {
    if (standing[i] == Standing::kAmong || (standing[i] == Standing::kBeside && !many_strays))
      continue;
    if (counted_by[i] <= (standing[i] == Standing::kApart ? kCountedByFew : 0))
      company[chosen[static_cast<size_t>(order[i])]] = false;
  }
  if (many_strays) LeaveOutGroups(points, company, pool);
  return company;
}

}  // namespace batten::internal
