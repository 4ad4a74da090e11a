// SPDX-License-Identifier: MIT
// PCL's clouds and meshes to batten and back.
#include "batten/pcl.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "batten/fitting/fit_surface.h"
#include "batten/fitting/sample_geometry.h"
#include "batten/geometry/make_surface.h"
#include "refusal.h"

namespace batten::internal::pcl_test {

constexpr double kSingle = 0x1p-23;  // relative: one rounding to single precision, and a factor
const float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(PclTest, PointsThatAreNotFiniteAreLeftOutAndIndicesTellWhichStay) {
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.push_back({1, 2, 3});
  cloud.push_back({kNan, 2, 3});
  cloud.push_back({4, 5, 6});
  cloud.push_back({7, 8, 9});
  EXPECT_EQ(FiniteIndices(cloud), (pcl::Indices{0, 2, 3}));
  EXPECT_EQ(CloudFromPcl(cloud).size(), 3);
  const pcl::Indices chosen{3, 1, 0};
  EXPECT_EQ(FiniteIndices(cloud, chosen), (pcl::Indices{3, 0}));
  const PointCloud some = CloudFromPcl(cloud, chosen);
  ASSERT_EQ(some.size(), 2);
  EXPECT_EQ(some.World(0), Eigen::Vector3d(7, 8, 9));
  EXPECT_EQ(CloudFromPcl(cloud, pcl::Indices{}).size(), 0);
  EXPECT_NE(RefusalOf([&] { CloudFromPcl(cloud, pcl::Indices{4}); }), "accepted");
}

TEST(PclTest, NormalsAndColoursAreKept) {
  pcl::PointCloud<pcl::PointXYZRGBNormal> cloud(2, 1);
  cloud[0].getNormalVector3fMap() = Eigen::Vector3f(0, 0, 1);
  cloud[1].getNormalVector3fMap() = Eigen::Vector3f(kNan, 0, 1);
  cloud[1].r = 200, cloud[1].g = 100, cloud[1].b = 1;
  const PointCloud points = CloudFromPcl(cloud);
  EXPECT_EQ(points.normals().col(0), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(points.normals().col(1), Eigen::Vector3d::Zero());  // none
  EXPECT_EQ(points.colours()(0, 1), 200);
  const auto back = PclFromCloud<pcl::PointXYZRGBNormal>(points);
  EXPECT_EQ(back[0].normal_z, 1);
  EXPECT_EQ(back[1].g, 100);
}

TEST(PclTest, TheSensorsPoseIsApplied) {
  pcl::PointCloud<pcl::PointNormal> cloud(1, 1);
  cloud[0].getVector3fMap() = Eigen::Vector3f(1, 0, 0);
  cloud[0].getNormalVector3fMap() = Eigen::Vector3f(1, 0, 0);
  cloud.sensor_origin_ = Eigen::Vector4f(10, 20, 30, 0);
  cloud.sensor_orientation_ =
      Eigen::AngleAxisf(0.5F * std::numbers::pi_v<float>, Eigen::Vector3f::UnitZ());
  const PointCloud moved = CloudFromPcl(cloud);
  EXPECT_LT((moved.World(0) - Eigen::Vector3d(10, 21, 30)).norm(), 30 * kSingle);
  EXPECT_LT((moved.normals().col(0) - Eigen::Vector3d::UnitY()).norm(), 4 * kSingle);
  EXPECT_EQ(CloudFromPcl(cloud, {}, PclPose::kNone).World(0), Eigen::Vector3d::UnitX());
}

TEST(PclTest, FarPointsGoThroughPclAndComeBack) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Random(3, 50);
  points.colwise() += Eigen::Vector3d(450000, 5400000, 300);
  const PointCloud cloud = PointCloud::FromWorld(points);
  const PointCloud back = CloudFromPcl(PclFromCloud<pcl::PointXYZ>(cloud));
  for (Eigen::Index k = 0; k < cloud.size(); ++k)
    EXPECT_LT((back.World(k) - cloud.World(k)).norm(), 4 * kSingle) << k;
}

TEST(PclTest, AFitBecomesPointsWithNormalDistanceAndCurvature) {
  constexpr double kRadius = 2, kNoise = 1e-3;
  // A cap of a sphere, whose mean curvature is −1/2 seen along outward normals.
  const NurbsSurface cap = MakeSphere({}, kRadius, {0, 1}, {0.2, 0.9});
  const PointCloud cloud = SampleGeometry(cap, {.count = 3000, .noise = kNoise});
  const SurfaceFit fit = FitSurface(cloud, {.threads = 2});
  const auto points = PclFromFit(fit, cloud);
  ASSERT_EQ(points.size(), 3000U);
  double curvature = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    EXPECT_LT((points[k].getVector3fMap().cast<double>() - cloud.World(at)).norm(), 4 * kSingle);
    EXPECT_FLOAT_EQ(points[k].intensity, static_cast<float>(fit.residuals[at]));
    // Normals of the fit and of the sphere at a point differ by the noise over the spacing.
    const double across =
        std::abs(points[k].getNormalVector3fMap().cast<double>().dot(cloud.World(at).normalized()));
    EXPECT_GT(across, 0.99);
    curvature += std::abs(static_cast<double>(points[k].curvature)) / 3000;
  }
  EXPECT_NEAR(curvature, 1 / kRadius, 0.1);
  EXPECT_NE(RefusalOf([&] { PclFromFit(fit, PointCloud()); }), "accepted");
}

TEST(PclTest, ASurfaceBecomesAPolygonMesh) {
  const NurbsSurface cap = MakeSphere({}, 2.0);
  const TessellateOptions options{.chord_tolerance = 0.01};
  const TriangleMesh mesh = Tessellate(cap, options);
  const pcl::PolygonMesh polygons = PclMeshFromSurface(cap, options, {0, 0, 1});
  ASSERT_EQ(static_cast<Eigen::Index>(polygons.polygons.size()), mesh.triangles.cols());
  pcl::PointCloud<pcl::PointNormal> vertices;
  pcl::fromPCLPointCloud2(polygons.cloud, vertices);
  ASSERT_EQ(static_cast<Eigen::Index>(vertices.size()), mesh.vertices.cols());
  for (const pcl::PointNormal& vertex : vertices) {
    const Eigen::Vector3f place = vertex.getVector3fMap() + Eigen::Vector3f::UnitZ();
    EXPECT_NEAR(place.norm(), 2, 4 * kSingle);
  }
  EXPECT_EQ(static_cast<int>(polygons.polygons[5].vertices[1]), mesh.triangles(1, 5));
}

}  // namespace batten::internal::pcl_test
