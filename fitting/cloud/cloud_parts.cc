// SPDX-License-Identifier: MIT
#include "batten/fitting/cloud_parts.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "batten/fitting/neighbours.h"
#include "fitting/cloud/connected_points.h"

namespace batten {

CloudParts FindCloudParts(const PointCloud& cloud, ThreadPool& pool) {
  if (cloud.size() == 0) throw std::invalid_argument("FindCloudParts: cloud: holds no points");
  const MergedCloud merged = MergeDuplicates(cloud);
  const Eigen::Matrix3Xd& points = merged.cloud.points();
  const std::vector<Eigen::Index> roots =
      internal::ConnectedPoints(points, NeighbourIndex(points, pool), pool);
  std::vector<std::vector<Eigen::Index>> members(static_cast<size_t>(points.cols()));
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const auto at = static_cast<size_t>(merged.place[static_cast<size_t>(k)]);
    members[static_cast<size_t>(roots[at])].push_back(k);
  }
  CloudParts found;
  const auto all = static_cast<double>(cloud.size());
  for (std::vector<Eigen::Index>& one : members) {
    const auto count = std::ssize(one);
    if (count == 0) continue;
    if (count < internal::kLeastPartPoints ||
        static_cast<double>(count) < internal::kLeastPartShare * all) {
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
