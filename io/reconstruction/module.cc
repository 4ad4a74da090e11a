// SPDX-License-Identifier: MIT
// The module libbatten_reconstruction.so hands out its functions.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <pcl/console/print.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/poisson.h>
// The templates that PCL's library holds as well, made here: those print to the standard streams
// whatever PCL's verbosity is. What they include is read before their words are taken from them.
#include <pcl/common/common.h>
#include <pcl/common/vector_average.h>

#include <boost/current_function.hpp>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <unordered_map>
#define printf(...) void(0)
#define fprintf(...) void(0)
#include <pcl/surface/impl/poisson.hpp>
#undef printf
#undef fprintf
#pragma GCC diagnostic pop

#include "io/mesh/poisson_functions.h"

namespace batten::internal {
namespace {

PoissonSurface Reconstruct(const Eigen::Matrix3Xd& points,
                           const Eigen::Matrix3Xd& normals,
                           int depth) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  const auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointNormal>>();
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    pcl::PointNormal point;
    point.getVector3fMap() = points.col(k).cast<float>();
    point.getNormalVector3fMap() = normals.col(k).cast<float>();
    cloud->push_back(point);
  }
  pcl::Poisson<pcl::PointNormal> poisson;
  poisson.setDepth(depth);
  poisson.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointNormal> vertices;
  std::vector<pcl::Vertices> polygons;
  poisson.reconstruct(vertices, polygons);
  PoissonSurface surface;
  surface.vertices.resize(3, Eigen::Index(vertices.size()));
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    surface.vertices.col(Eigen::Index(k)) = vertices[k].getVector3fMap().cast<double>();
  }
  for (const pcl::Vertices& polygon : polygons) {
    surface.faces.emplace_back(polygon.vertices.begin(), polygon.vertices.end());
  }
  return surface;
}

}  // namespace
}  // namespace batten::internal

extern "C" __attribute__((visibility("default"))) const batten::internal::PoissonFunctions*
batten_reconstruction_functions() {
  static constexpr batten::internal::PoissonFunctions kFunctions = {batten::internal::Reconstruct};
  return &kFunctions;
}
