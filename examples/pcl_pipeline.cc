// SPDX-License-Identifier: MIT
// From PCL to CAD: voxel grid, RANSAC takes the table away, Euclidean clusters, a surface to each.
//   pcl_pipeline OUT.step
#include <batten/batten.h>
#include <batten/pcl.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <cmath>
#include <iostream>

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

// A table with two domes on it.
Cloud::Ptr Scene() {
  const Cloud::Ptr scene(new Cloud);
  for (int k = 0; k < 60000; ++k) {
    const float x = 0.01F * static_cast<float>(k / 200), y = 0.01F * static_cast<float>(k % 200);
    const float aside = std::hypot(x < 1.5F ? x - 0.8F : x - 2.2F, y - 1);
    scene->push_back({x, y, aside < 0.5F ? 0.1F + 0.8F * (0.25F - aside * aside) : 0});
  }
  return scene;
}

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const Cloud::Ptr thinned(new Cloud);
  pcl::VoxelGrid<pcl::PointXYZ> voxels;
  voxels.setInputCloud(Scene());
  voxels.setLeafSize(0.015F, 0.015F, 0.015F);
  voxels.filter(*thinned);

  pcl::SACSegmentation<pcl::PointXYZ> ransac;
  ransac.setModelType(pcl::SACMODEL_PLANE);
  ransac.setDistanceThreshold(0.02);
  ransac.setInputCloud(thinned);
  pcl::PointIndices table;
  pcl::ModelCoefficients plane;
  ransac.segment(table, plane);

  pcl::EuclideanClusterExtraction<pcl::PointXYZ> euclidean;
  euclidean.setClusterTolerance(0.06);
  euclidean.setMinClusterSize(100);
  euclidean.setInputCloud(thinned);
  const pcl::IndicesPtr above(new pcl::Indices);
  for (pcl::index_t k = 0; k < static_cast<pcl::index_t>(thinned->size()); ++k)
    if (!std::binary_search(table.indices.begin(), table.indices.end(), k)) above->push_back(k);
  euclidean.setIndices(above);
  std::vector<pcl::PointIndices> clusters;
  euclidean.extract(clusters);
  std::vector<batten::Geometry> surfaces;
  for (const pcl::PointIndices& cluster : clusters) {
    const auto fit = batten::FitSurface(batten::CloudFromPcl(*thinned, cluster.indices));
    std::cout << fit.report.OneLine() << '\n';
    surfaces.push_back(fit.surface);
  }
  batten::WriteGeometry(surfaces, argv[1]);
  return surfaces.size() == 2 ? 0 : 1;
}
