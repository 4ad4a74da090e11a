// SPDX-License-Identifier: MIT
#include "batten/fitting/clean_cloud.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#define PCL_NO_PRECOMPILE  // of its libraries this takes pcl_common alone
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/filters/impl/filter_indices.hpp>
#include <pcl/filters/impl/statistical_outlier_removal.hpp>
#pragma GCC diagnostic pop

namespace batten {

std::vector<Eigen::Index> WithoutStatisticalOutliers(const PointCloud& cloud,
                                                     const StatisticalRemoval& options) {
  if (options.neighbours < 1)
    throw std::invalid_argument("statistical removal: at least one neighbour is needed");
  if (!(options.deviations > 0) || !std::isfinite(options.deviations))
    throw std::invalid_argument("statistical removal: the deviations must be a positive number");
  std::vector<Eigen::Index> kept;
  if (cloud.size() <= options.neighbours) {  // too few to tell
    for (Eigen::Index k = 0; k < cloud.size(); ++k) kept.push_back(k);
    return kept;
  }
  const Eigen::Vector3d low = cloud.points().rowwise().minCoeff(),
                        high = cloud.points().rowwise().maxCoeff(), centre = low / 2 + high / 2;
  const double reach = (high - centre).maxCoeff(),
               scale = reach > 0 ? std::exp2(std::clamp(-std::ilogb(reach), -1000, 1000)) : 1;
  const auto local = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  local->reserve(static_cast<std::size_t>(cloud.size()));
  for (const auto point : cloud.points().colwise()) {
    const Eigen::Vector3f at = ((point - centre) * scale).cast<float>();
    local->push_back(pcl::PointXYZ(at[0], at[1], at[2]));
  }
  pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
  filter.setInputCloud(local);
  filter.setMeanK(options.neighbours);
  filter.setStddevMulThresh(options.deviations);
  pcl::Indices indices;
  filter.filter(indices);
  kept.assign(indices.begin(), indices.end());
  return kept;
}

}  // namespace batten
