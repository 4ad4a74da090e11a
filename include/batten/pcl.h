// SPDX-License-Identifier: MIT
// Between PCL's clouds and meshes and batten. Header-only; the component `pcl` of batten's package
// finds PCL.
#pragma once

#include <pcl/PolygonMesh.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/type_traits.h>
#include <pcl/types.h>

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "batten/fitting/point_cloud.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/curvature.h"
#include "batten/geometry/surface_evaluator.h"
#include "batten/geometry/tessellate.h"

namespace batten {

// Which pose the points of a PCL cloud are read in.
enum class PclPose {
  kSensor,  // sensor_orientation_ and sensor_origin_ applied, as PCL's viewer does; often none
  kNone,    // coordinates as they stand
};

// The indices of the points whose x, y and z are finite, of those given or of all, in their order:
// entry k is the point k of CloudFromPcl. Throws std::invalid_argument for an index that the cloud
// does not have.
template <typename PointT>
pcl::Indices FiniteIndices(const pcl::PointCloud<PointT>& cloud,
                           const std::optional<pcl::Indices>& indices = {}) {
  pcl::Indices finite;
  const auto count = static_cast<pcl::index_t>(cloud.size());
  const auto take = [&](pcl::index_t k) {
    if (k < 0 || k >= count)
      throw std::invalid_argument("FiniteIndices: no point of the cloud has that index");
    if (cloud[k].getVector3fMap().allFinite()) finite.push_back(k);
  };
  if (indices) {
    for (const pcl::index_t k : *indices) take(k);
  } else {
    for (pcl::index_t k = 0; k < count; ++k) take(k);
  }
  return finite;
}

// The cloud of these points in double precision. Points that are not finite are left out
// (FiniteIndices tells which stay); normals and colours are kept where PointT has them, a normal
// that is not finite as none. Other fields have no place in PointCloud. O(m).
template <typename PointT>
PointCloud CloudFromPcl(const pcl::PointCloud<PointT>& cloud,
                        const std::optional<pcl::Indices>& indices = {},
                        PclPose pose = PclPose::kSensor) {
  const pcl::Indices kept = FiniteIndices(cloud, indices);
  const auto count = static_cast<Eigen::Index>(kept.size());
  Eigen::Isometry3d sensor = Eigen::Isometry3d::Identity();
  if (pose == PclPose::kSensor) {
    sensor.linear() = cloud.sensor_orientation_.normalized().template cast<double>().matrix();
    sensor.translation() = cloud.sensor_origin_.template head<3>().template cast<double>();
  }
  Eigen::Matrix3Xd points(3, count), normals(3, count);
  PointCloud::Colours colours(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const PointT& point = cloud[kept[static_cast<std::size_t>(k)]];
    points.col(k) = sensor * point.getVector3fMap().template cast<double>();
    if constexpr (pcl::traits::has_normal_v<PointT>) {
      const Eigen::Vector3f normal = point.getNormalVector3fMap();
      normals.col(k).setZero();
      if (normal.allFinite()) normals.col(k) = sensor.linear() * normal.template cast<double>();
    }
    if constexpr (pcl::traits::has_color_v<PointT>) colours.col(k) << point.r, point.g, point.b;
  }
  PointCloud result = PointCloud::FromWorld(std::move(points));
  if constexpr (pcl::traits::has_normal_v<PointT>) result.set_normals(std::move(normals));
  if constexpr (pcl::traits::has_color_v<PointT>) result.set_colours(std::move(colours));
  return result;
}

namespace pcl_detail {

// An empty PCL cloud for points about `origin`, and what is to be subtracted from them: single
// precision holds a few digits only, which are spent on coordinates relative to sensor_origin_.
template <typename PointT>
Eigen::Vector3d StartAt(const Eigen::Vector3d& origin, pcl::PointCloud<PointT>& cloud) {
  cloud.sensor_origin_.template head<3>() = origin.cast<float>();
  return cloud.sensor_origin_.template head<3>().template cast<double>();
}

template <typename PointT>
void SetNormal(const std::optional<Eigen::Vector3d>& normal, PointT& point) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  point.getNormalVector3fMap() =
      normal ? Eigen::Vector3f(normal->cast<float>()) : Eigen::Vector3f::Constant(kNone);
}

}  // namespace pcl_detail

// The cloud in PCL's single precision, relative to sensor_origin_, which takes the cloud's origin
// up: CloudFromPcl gives the same points again to 2^-24 of their distance from that. Normals and
// colours are written where both have them; a cloud without colours leaves PointT's own. O(m).
template <typename PointT>
pcl::PointCloud<PointT> PclFromCloud(const PointCloud& cloud) {
  pcl::PointCloud<PointT> result;
  const Eigen::Vector3d origin = pcl_detail::StartAt(cloud.origin(), result);
  result.resize(static_cast<std::size_t>(cloud.size()));
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    PointT& point = result[static_cast<std::size_t>(k)];
    point.getVector3fMap() = (cloud.World(k) - origin).cast<float>();
    if constexpr (pcl::traits::has_normal_v<PointT>)
      if (cloud.normals().cols() > 0) pcl_detail::SetNormal({cloud.normals().col(k)}, point);
    if constexpr (pcl::traits::has_color_v<PointT>) {
      if (cloud.colours().cols() == 0) continue;
      const auto colour = cloud.colours().col(k);
      point.r = colour[0], point.g = colour[1], point.b = colour[2];
    }
  }
  return result;
}

// The points that were fitted, one for one, in world coordinates relative to sensor_origin_: normal
// of the surface at the foot point, signed distance from it as intensity, and as curvature the mean
// curvature there. Normal or curvature are NaN where the surface has none. Throws
// std::invalid_argument unless the fit is one of as many points. O(m).
inline pcl::PointCloud<pcl::PointXYZINormal> PclFromFit(const SurfaceFit& fit,
                                                        const PointCloud& cloud) {
  if (fit.residuals.size() != cloud.size())
    throw std::invalid_argument("PclFromFit: the fit is not one of this cloud");
  auto result = PclFromCloud<pcl::PointXYZINormal>(cloud);
  const SurfaceEvaluator surface(fit.surface);
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    pcl::PointXYZINormal& point = result[static_cast<std::size_t>(k)];
    const double u = fit.parameters(0, k), v = fit.parameters(1, k);
    pcl_detail::SetNormal(surface.NormalAt(u, v), point);
    const std::optional<SurfaceCurvature> curvature = CurvatureOf(surface.JetAt(u, v));
    point.intensity = static_cast<float>(fit.residuals[k]);
    point.curvature =
        curvature ? static_cast<float>(curvature->mean) : std::numeric_limits<float>::quiet_NaN();
  }
  return result;
}

// The surface as triangles with a normal at each vertex, less `origin`, which keeps far coordinates
// apart in single precision. Throws as Tessellate does.
inline pcl::PolygonMesh PclMeshFromSurface(
    const NurbsSurface& surface,
    const TessellateOptions& options = {},
    const Eigen::Vector3d& origin = Eigen::Vector3d::Zero()) {
  const TriangleMesh mesh = Tessellate(surface, options);
  pcl::PointCloud<pcl::PointNormal> vertices;
  vertices.resize(static_cast<std::size_t>(mesh.vertices.cols()));
  for (Eigen::Index k = 0; k < mesh.vertices.cols(); ++k) {
    pcl::PointNormal& vertex = vertices[static_cast<std::size_t>(k)];
    vertex.getVector3fMap() = (mesh.vertices.col(k) - origin).cast<float>();
    pcl_detail::SetNormal({mesh.normals.col(k)}, vertex);
  }
  pcl::PolygonMesh result;
  pcl::toPCLPointCloud2(vertices, result.cloud);
  result.polygons.resize(static_cast<std::size_t>(mesh.triangles.cols()));
  for (Eigen::Index k = 0; k < mesh.triangles.cols(); ++k) {
    const auto corners = mesh.triangles.col(k);
    for (const int corner : corners)
      result.polygons[static_cast<std::size_t>(k)].vertices.push_back(
          static_cast<pcl::index_t>(corner));
  }
  return result;
}

}  // namespace batten
