// SPDX-License-Identifier: MIT
#include "fitting/neighbours/normals.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#include <pcl/common/centroid.h>
#include <pcl/common/eigen.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#pragma GCC diagnostic pop

namespace batten::internal {

Eigen::Matrix3Xd EstimateNormals(const NeighbourIndex& index,
                                 const Eigen::Matrix3Xd& points,
                                 const Eigen::Matrix3Xd& queries,
                                 int k) {
  k = static_cast<int>(std::min<Eigen::Index>(k, points.cols()));
  const std::vector<int> neighbours = index.Nearest(queries, k);
  Eigen::Matrix3Xd normals(3, queries.cols());
  pcl::PointCloud<pcl::PointXYZ> local;
  local.resize(static_cast<size_t>(k));
  for (Eigen::Index i = 0; i < queries.cols(); ++i) {
    // Neighbours relative to the query keep float exact enough at any distance from the origin.
    for (int j = 0; j < k; ++j) {
      const Eigen::Vector3d d = points.col(neighbours[i * k + j]) - queries.col(i);
      local[j] = pcl::PointXYZ(
          static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2]));
    }
    Eigen::Matrix3f covariance;
    Eigen::Vector4f centroid;
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    if (k >= 3 && pcl::computeMeanAndCovarianceMatrix(local, covariance, centroid) > 0) {
      const float scale = covariance.cwiseAbs().maxCoeff();
      if (scale > 0) {
        float least;
        pcl::eigen33((covariance / scale).eval(), least, normal);
      }
    }
    normals.col(i) = normal.allFinite() ? normal.cast<double>().eval() : Eigen::Vector3d::Zero();
  }
  return normals;
}

}  // namespace batten::internal
