// SPDX-License-Identifier: MIT
#include "fitting/cloud/voxel_downsample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace batten::internal {

DownsampledCloud Thinned(const PointCloud& cloud, double cell) {
  if (!(cell > 0) || !std::isfinite(cell)) {
    throw std::invalid_argument("Thinned: the side of the cells must be positive");
  }
  const Eigen::Matrix3Xd& p = cloud.points();
  const auto m = static_cast<std::size_t>(p.cols());
  if (m == 0) return {cloud, {}, {}};
  const Eigen::Vector3d corner = p.rowwise().minCoeff();
  // Cell numbers are doubles; if even these overflow, no two points share a cell.
  if (!((p.rowwise().maxCoeff() - corner) / cell).allFinite()) {
    DownsampledCloud all{cloud, std::vector<Eigen::Index>(m), {}};
    std::iota(all.kept.begin(), all.kept.end(), Eigen::Index{0});
    all.stands = all.kept;
    return all;
  }
  std::vector<std::array<double, 3>> keys(m);
  for (std::size_t k = 0; k < m; ++k) {
    const Eigen::Vector3d from = p.col(static_cast<Eigen::Index>(k)) - corner;
    for (int d = 0; d < 3; ++d) keys[k][static_cast<std::size_t>(d)] = std::floor(from[d] / cell);
  }
  std::vector<Eigen::Index> order(m);
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const auto key = [&](Eigen::Index k) -> const auto& { return keys[static_cast<std::size_t>(k)]; };
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return key(a) != key(b) ? key(a) < key(b) : a < b;
  });
  DownsampledCloud result;
  result.stands.resize(m);
  std::vector<Eigen::Index>& stays = result.kept;
  for (std::size_t begin = 0, end; begin < m; begin = end) {
    end = begin + 1;
    while (end < m && key(order[end]) == key(order[begin])) ++end;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t i = begin; i < end; ++i) mean += p.col(order[i]) - p.col(order[begin]);
    mean = p.col(order[begin]) + mean / static_cast<double>(end - begin);
    Eigen::Index nearest = order[begin];
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = begin; i < end; ++i) {
      const double distance = (p.col(order[i]) - mean).squaredNorm();
      if (!(distance < least)) continue;
      least = distance;
      nearest = order[i];
    }
    stays.push_back(nearest);
    for (std::size_t i = begin; i < end; ++i)
      result.stands[static_cast<std::size_t>(order[i])] = nearest;
  }
  std::sort(stays.begin(), stays.end());
  for (Eigen::Index& stands : result.stands)
    stands = std::lower_bound(stays.begin(), stays.end(), stands) - stays.begin();
  result.cloud = cloud.Picked(stays);
  return result;
}

DownsampledCloud WithPoints(const PointCloud& cloud,
                            DownsampledCloud thinned,
                            const std::vector<Eigen::Index>& more) {
  // Numbers of the cloud first, then of the thinned one.
  for (Eigen::Index& stands : thinned.stands)
    stands = thinned.kept[static_cast<std::size_t>(stands)];
  for (const Eigen::Index k : more) thinned.stands[static_cast<std::size_t>(k)] = k;
  std::vector<Eigen::Index>& kept = thinned.kept;
  kept.insert(kept.end(), more.begin(), more.end());
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  for (Eigen::Index& stands : thinned.stands)
    stands = std::lower_bound(kept.begin(), kept.end(), stands) - kept.begin();
  thinned.cloud = cloud.Picked(kept);
  return thinned;
}

}  // namespace batten::internal
