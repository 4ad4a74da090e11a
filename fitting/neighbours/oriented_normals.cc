// SPDX-License-Identifier: MIT
#include "fitting/neighbours/oriented_normals.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <tuple>
#include <vector>

#include "fitting/neighbours/normals.h"

namespace batten::internal {

Eigen::Matrix3Xd OutwardNormals(const NeighbourIndex& index,
                                const Eigen::Matrix3Xd& points,
                                int k) {
  const Eigen::Index count = points.cols();
  k = static_cast<int>(std::min<Eigen::Index>(k, count));
  Eigen::Matrix3Xd normals = EstimateNormals(index, points, points, k);
  const std::vector<int> nearest = index.Nearest(points, k);
  // Both ways: a lone point is the neighbour of none.
  std::vector<std::vector<int>> beside(static_cast<std::size_t>(count));
  for (Eigen::Index a = 0; a < count; ++a) {
    for (int j = 1; j < k; ++j) {
      const int b = nearest[static_cast<std::size_t>(a * k + j)];
      beside[static_cast<std::size_t>(a)].push_back(b);
      beside[static_cast<std::size_t>(b)].push_back(static_cast<int>(a));
    }
  }
  const Eigen::Vector3d middle = points.rowwise().mean();
  std::vector<int> outermost(static_cast<std::size_t>(count));
  std::iota(outermost.begin(), outermost.end(), 0);
  std::sort(outermost.begin(), outermost.end(), [&](int a, int b) {
    const double one = (points.col(a) - middle).squaredNorm();
    const double two = (points.col(b) - middle).squaredNorm();
    return one != two ? one > two : a < b;
  });
  std::vector<bool> done(static_cast<std::size_t>(count), false);
  using Edge = std::tuple<double, int, int>;  // turn, to, from
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> edges;
  const auto take = [&](int a) {
    done[static_cast<std::size_t>(a)] = true;
    for (const int b : beside[static_cast<std::size_t>(a)]) {
      if (done[static_cast<std::size_t>(b)]) continue;
      // Far neighbours may lie on another wall: of equal turn the nearer comes first.
      edges.emplace(1 - std::abs(normals.col(a).dot(normals.col(b))), b, a);
    }
  };
  for (const int first : outermost) {
    if (done[static_cast<std::size_t>(first)]) continue;
    if (normals.col(first).dot(points.col(first) - middle) < 0) normals.col(first) *= -1;
    take(first);
    while (!edges.empty()) {
      const auto [turn, to, from] = edges.top();
      edges.pop();
      if (done[static_cast<std::size_t>(to)]) continue;
      if (normals.col(to).dot(normals.col(from)) < 0) normals.col(to) *= -1;
      take(to);
    }
  }
  return normals;
}

}  // namespace batten::internal
