// SPDX-License-Identifier: MIT
#include "batten/geometry/triangle_samples.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "geometry/mesh/triangle_measure.h"

namespace batten::internal::triangle_samples_test {
namespace {

TriangleSurface RandomTriangles(int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-1, 1);
  TriangleSurface surface;
  surface.vertices.resize(3, 3 * count);
  surface.triangles.resize(3, count);
  for (double& x : surface.vertices.reshaped()) x = place(random);
  for (int k = 0; k < 3 * count; ++k) surface.triangles(k % 3, k / 3) = k;
  return surface;
}

TEST(SampleTrianglesTest, AreOnTheirTrianglesEvenlyByArea) {
  const TriangleSurface surface = RandomTriangles(30, 1);
  const double spacing = 0.02;
  const TriangleSamples samples = SampleTriangles(surface, spacing);
  std::vector<Eigen::Vector3d> sum(30, Eigen::Vector3d::Zero());
  std::vector<int> count(30, 0);
  for (Eigen::Index k = 0; k < samples.points.cols(); ++k) {
    const int t = samples.triangles[k];
    Eigen::Matrix3d corners = surface.vertices.middleCols(3 * t, 3);
    const Eigen::Vector3d normal =
        (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).normalized();
    EXPECT_NEAR(samples.normals.col(k).dot(normal), 1, 1e-12);
    const Eigen::Vector3d p = samples.points.col(k);
    EXPECT_NEAR((p - corners.col(0)).dot(normal), 0, 1e-12);
    // Barycentric coordinates from areas.
    double all = 0;
    for (int c = 0; c < 3; ++c) {
      const double part = (corners.col(c) - p).cross(corners.col((c + 1) % 3) - p).dot(normal);
      EXPECT_GE(part, -1e-12);
      all += part;
    }
    EXPECT_NEAR(all,
                (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).norm(),
                1e-12);
    sum[std::size_t(t)] += p;
    ++count[std::size_t(t)];
  }
  for (int t = 0; t < 30; ++t) {
    const Eigen::Matrix3d corners = surface.vertices.middleCols(3 * t, 3);
    const double area =
        (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).norm() / 2;
    EXPECT_NEAR(count[std::size_t(t)], area / (spacing * spacing) - 0.5, 1) << t;
    if (count[std::size_t(t)] < 100) continue;
    // Even: their middle is the triangle's, nearer than that of as many at random.
    const double size = std::sqrt(area);
    EXPECT_LT((sum[std::size_t(t)] / count[std::size_t(t)] - corners.rowwise().mean()).norm(),
              0.5 * size / std::sqrt(count[std::size_t(t)]))
        << t;
  }
  EXPECT_EQ(SampleTriangles(surface, spacing).points, samples.points);
}

TEST(SampleTrianglesTest, VerticesThatAreDenserStandForTheirTriangles) {
  const TriangleSurface surface = RandomTriangles(50, 2);
  EXPECT_EQ(SampleTriangles(surface, 10).points.cols(), 0);
  const double spacing = SampleSpacing(surface, 1000);
  EXPECT_NEAR(spacing * spacing * 1000, AreaOf(surface), 1e-9);
  EXPECT_NEAR(double(SampleTriangles(surface, spacing).points.cols()), 1000 - 25, 25);
}

// Long triangles make a surface sparse; all in one plane they are flat too, and bent they are not.
TEST(IsSparseTest, IsOfLongTrianglesAlone) {
  // A strip of even squares, and beside it one of the same squares drawn out.
  for (const double stretch : {1.0, 2.0, 20.0}) {
    const int side = 12;
    TriangleSurface surface;
    surface.vertices.resize(3, (side + 1) * (side + 1));
    surface.triangles.resize(3, 2 * side * side);
    for (int i = 0; i <= side; ++i) {
      for (int j = 0; j <= side; ++j) {
        const double x = j < side ? j : side - 1 + stretch;
        surface.vertices.col(i * (side + 1) + j) << x, i, 0;
      }
    }
    for (int i = 0, t = 0; i < side; ++i) {
      for (int j = 0; j < side; ++j, t += 2) {
        const int at = i * (side + 1) + j;
        surface.triangles.col(t) << at, at + 1, at + side + 2;
        surface.triangles.col(t + 1) << at, at + side + 2, at + side + 1;
      }
    }
    EXPECT_EQ(IsSparse(surface), stretch > 10) << stretch;
    EXPECT_TRUE(IsMostlyFlat(surface));
    for (auto vertex : surface.vertices.colwise())
      vertex.z() = 0.01 * (vertex.x() * vertex.x() + vertex.x() * vertex.y());
    EXPECT_FALSE(IsMostlyFlat(surface)) << stretch;
  }
}

// The side of a polygonal prism, which stands for a cylinder.
TEST(ChordHeightTest, IsThatOfTheRoundBodyWhateverItsHeight) {
  for (const int sides : {14, 20, 60}) {
    for (const double height : {0.1, 5.0}) {
      TriangleSurface surface;
      surface.vertices.resize(3, 2 * sides);
      surface.triangles.resize(3, 2 * sides);
      for (int k = 0; k < sides; ++k) {
        const double angle = 2 * std::numbers::pi * k / sides;
        surface.vertices.col(k) << std::cos(angle), std::sin(angle), 0;
        surface.vertices.col(sides + k) << std::cos(angle), std::sin(angle), height;
        const int next = (k + 1) % sides;
        surface.triangles.col(2 * k) << k, next, sides + next;
        surface.triangles.col(2 * k + 1) << k, sides + next, sides + k;
      }
      const double truth = 1 - std::cos(std::numbers::pi / sides);
      EXPECT_NEAR(ChordHeight(surface), sides < 15 ? 0 : truth, 0.05 * truth)
          << sides << " " << height;
    }
  }
}

}  // namespace
}  // namespace batten::internal::triangle_samples_test
