// SPDX-License-Identifier: MIT
// The shapes that PCL's RANSAC takes from points one after the other, each time the one of plane,
// cylinder, sphere and cone with most points: the seconds, then the number and the kind of the
// shape of each point, -1 where it has none. EPSILON is the distance of points from their shape;
// MIN points make a shape. Links PCL and nothing of batten. Usage: pcl_shapes POINTS.f64 EPSILON
// MIN NEIGHBOURS
#include <pcl/ModelCoefficients.h>
#include <pcl/features/normal_3d.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "comparator.h"

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;

// The points of the largest shape of a kind among these.
pcl::PointIndices::Ptr LargestOf(int model,
                                 double epsilon,
                                 double most_radius,
                                 const Cloud::Ptr& cloud,
                                 const Normals::Ptr& normals,
                                 const pcl::PointIndices::Ptr& among) {
  pcl::SACSegmentationFromNormals<pcl::PointXYZ, pcl::Normal> search;
  search.setOptimizeCoefficients(true);
  search.setModelType(model);
  search.setMethodType(pcl::SAC_RANSAC);
  search.setNormalDistanceWeight(0.1);
  search.setMaxIterations(2000);
  search.setDistanceThreshold(epsilon);
  search.setRadiusLimits(0, most_radius);
  search.setInputCloud(cloud);
  search.setInputNormals(normals);
  search.setIndices(among);
  const pcl::PointIndices::Ptr found(new pcl::PointIndices);
  pcl::ModelCoefficients coefficients;
  search.segment(*found, coefficients);
  return found;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: pcl_shapes POINTS.f64 EPSILON MIN NEIGHBOURS\n");
    return 2;
  }
  std::size_t numbers = 0;
  const double* const points = ReadDoubles(argv[1], &numbers);
  if (!points || numbers % 3 != 0) {
    std::fprintf(stderr, "pcl_shapes: can't use %s\n", argv[1]);
    return 1;
  }
  const Seconds begin = Now();
  const Cloud::Ptr cloud(new Cloud);
  for (std::size_t k = 0; k < numbers; k += 3)
    cloud->emplace_back(float(points[k]), float(points[k + 1]), float(points[k + 2]));
  const Normals::Ptr normals(new Normals);
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(cloud);
  estimation.setSearchMethod(
      pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
  estimation.setKSearch(std::atoi(argv[4]));
  estimation.compute(*normals);
  const double epsilon = std::atof(argv[2]);
  const auto least = std::size_t(std::atoi(argv[3]));
  std::vector<int> number(cloud->size(), -1);
  std::vector<const char*> kinds;
  pcl::PointIndices::Ptr left(new pcl::PointIndices);
  for (std::size_t k = 0; k < cloud->size(); ++k) left->indices.push_back(static_cast<int>(k));
  constexpr std::pair<int, const char*> kModels[] = {{pcl::SACMODEL_NORMAL_PLANE, "plane"},
                                                     {pcl::SACMODEL_CYLINDER, "cylinder"},
                                                     {pcl::SACMODEL_NORMAL_SPHERE, "sphere"},
                                                     {pcl::SACMODEL_CONE, "cone"}};
  while (left->indices.size() >= least) {
    pcl::PointIndices::Ptr best;
    const char* kind = nullptr;
    for (const auto& [model, name] : kModels) {
      const pcl::PointIndices::Ptr found = LargestOf(model, epsilon, 10, cloud, normals, left);
      if (best && found->indices.size() <= best->indices.size()) continue;
      best = found;
      kind = name;
    }
    if (best->indices.size() < least) break;
    for (const int k : best->indices) number[std::size_t(k)] = static_cast<int>(kinds.size());
    kinds.push_back(kind);
    std::erase_if(left->indices, [&](int k) { return number[std::size_t(k)] >= 0; });
  }
  std::printf("%g\n", Since(begin).cpu);
  for (const int k : number) std::printf("%d %s\n", k, k < 0 ? "none" : kinds[std::size_t(k)]);
}
