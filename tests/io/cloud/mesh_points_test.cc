// SPDX-License-Identifier: MIT
// Meshes among files of points: their triangles count where the vertices do not stand for them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "batten/io/read_cloud.h"
#include "temporary_folder.h"

namespace batten::internal::mesh_points_test {

using ::testing::HasSubstr;

CloudFile Read(const std::vector<std::string>& paths, CloudFaces faces) {
  CloudReadOptions options;
  options.faces = faces;
  return ReadCloud(paths, options);
}

// A box of sides 1, 2 and 3 as OBJ, far from the origin.
std::string BoxObj() {
  std::string text;
  for (int k = 0; k < 8; ++k)
    text += fmt::format("v {} {} {}\n", 1000 + (k & 1), (k >> 1 & 1) * 2, (k >> 2) * 3);
  return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

// How far a point is from the nearest face of the box.
double OffBox(const Eigen::Vector3d& p) {
  const Eigen::Array3d at = p.array() - Eigen::Array3d(1000, 0, 0), size(1, 2, 3);
  return std::min(at.abs().minCoeff(), (at - size).abs().minCoeff());
}

TEST(MeshPointsTest, TrianglesCountBesideTheVerticesOfABox) {
  const TemporaryFolder folder;
  const std::string path = folder.With("box.obj", BoxObj());
  const CloudFile ignored = ReadCloud({path}), kept = Read({path}, CloudFaces::kKept),
                  sampled = Read({path}, CloudFaces::kSampled);
  EXPECT_FALSE(ignored.mesh);
  for (const CloudFile* file : {&kept, &sampled}) {
    ASSERT_TRUE(file->mesh);
    EXPECT_EQ(file->mesh->faces.surface.triangles.cols(), 12);
    EXPECT_EQ(file->mesh->faces.open_edges, 0);
    EXPECT_EQ(file->mesh->faces.crowded_edges, 0);
    EXPECT_EQ(file->points_in_file, file->cloud.size());
  }
  EXPECT_EQ(kept.cloud.size(), 8);
  EXPECT_EQ(kept.mesh->sampled, 0);
  const Eigen::Index size = sampled.cloud.size();
  EXPECT_EQ(size, 8 + sampled.mesh->sampled);
  EXPECT_GT(size, 19000);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < size; ++k) {
    if (k < 8) {
      EXPECT_EQ(sampled.cloud.World(k), kept.cloud.World(k));
    }
    ASSERT_LT(OffBox(sampled.cloud.World(k)), 1e-12);
    mean += sampled.cloud.World(k) / double(size);
  }
  EXPECT_LT((mean - Eigen::Vector3d(1000.5, 1, 1.5)).norm(), 0.01);
}

TEST(MeshPointsTest, WhatIsChosenOfPointsIsChosenOfTriangles) {
  const TemporaryFolder folder;
  const std::string path = folder.With("box.obj", BoxObj());
  CloudReadOptions options;
  options.faces = CloudFaces::kSampled;
  options.box = Eigen::AlignedBox3d(Eigen::Vector3d(999, -1, -1), Eigen::Vector3d(1002, 3, 1));
  const CloudFile part = ReadCloud({path}, options);
  // Of the area 22 the bottom, 2, and a third of the sides, 6, are within.
  EXPECT_NEAR(double(part.mesh->sampled), 20000 * 8.0 / 22, 100);
  for (Eigen::Index k = 0; k < part.cloud.size(); ++k) ASSERT_LE(part.cloud.World(k).z(), 1);
  options.columns = {{"x", "x"}, {"y", "y"}, {"z", "z"}};
  const CloudFile rows = ReadCloud({path}, options);
  EXPECT_EQ(rows.mesh->sampled, 0);
  ASSERT_EQ(rows.remarks.size(), 1U);
  EXPECT_THAT(rows.remarks[0], HasSubstr("not what lies between them, for rows are chosen"));
  // The box holds a vertex and next to nothing of the triangles: blocks have points all the same.
  options.columns.clear();
  options.box = Eigen::AlignedBox3d(Eigen::Vector3d(1000, 0, 0), Eigen::Vector3d(1000, 0, 0));
  const CloudFile corner = ReadCloud({path}, options);
  EXPECT_EQ(corner.cloud.size(), 1);
  EXPECT_EQ(corner.blocks, std::vector<Eigen::Index>{0});
}

// A scan's vertices stand for it, noisy as they are; several files are one mesh.
TEST(MeshPointsTest, DenseVerticesStandForTheirTriangles) {
  const TemporaryFolder folder;
  std::vector<std::string> paths;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 0.05);
  for (int part = 0; part < 2; ++part) {
    std::string text;
    constexpr int kSide = 30;
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j)
        text += fmt::format("v {} {} {}\n", i + 100 * part, j, std::sin(0.3 * i) + noise(random));
    }
    for (int i = 0; i + 1 < kSide; ++i) {
      for (int j = 0; j + 1 < kSide; ++j) {
        const int at = i * kSide + j + 1;
        text += fmt::format(
            "f {} {} {}\nf {} {} {}\n", at, at + kSide, at + 1, at + 1, at + kSide, at + kSide + 1);
      }
    }
    paths.push_back(folder.With(fmt::format("{}.obj", part), text));
  }
  const CloudFile file = Read(paths, CloudFaces::kSampled);
  ASSERT_TRUE(file.mesh);
  EXPECT_EQ(file.mesh->sampled, 0);
  EXPECT_EQ(file.cloud.size(), 1800);
  EXPECT_EQ(file.mesh->faces.surface.triangles.cols(), 2 * 2 * 29 * 29);
  EXPECT_EQ(file.mesh->faces.open_edges, 2 * 4 * 29);
  EXPECT_EQ(file.mesh->faces.surface.triangles.maxCoeff(), 1799);
}

TEST(MeshPointsTest, FacesThatCantBeReadAreTold) {
  const TemporaryFolder folder;
  const std::string path = folder.With("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  const CloudFile file = Read({path}, CloudFaces::kSampled);
  EXPECT_EQ(file.cloud.size(), 3);
  EXPECT_FALSE(file.mesh);
  ASSERT_EQ(file.remarks.size(), 1U);
  EXPECT_THAT(file.remarks[0], HasSubstr("its vertices count, not what lies between them"));
  // By another name they are not read, and degrees are no place for them.
  CloudReadOptions named;
  named.faces = CloudFaces::kSampled;
  named.format = "obj";
  const CloudFile other = ReadCloud({folder.With("box.dat", BoxObj())}, named);
  EXPECT_FALSE(other.mesh);
  ASSERT_EQ(other.remarks.size(), 1U);
  EXPECT_THAT(other.remarks[0], HasSubstr("faces are read from files named"));
  CloudReadOptions degrees;
  degrees.faces = CloudFaces::kSampled;
  degrees.projection = CloudProjection::kLocal;
  const CloudFile local =
      ReadCloud({folder.With("d.obj", "v 8 47 0\nv 8.01 47 0\nv 8 47.01 0\nf 1 2 3\n")}, degrees);
  EXPECT_FALSE(local.mesh);
  EXPECT_EQ(local.cloud.size(), 3);
  EXPECT_THAT(local.remarks.back(), HasSubstr("degrees became metres"));
  for (const char* element : {"element face 1", "element\tface 1", " element  face 1"}) {
    const std::string spelled = folder.With(
        "s.ply",
        std::string("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
                    "y\nproperty float z\n") +
            element +
            "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 "
            "0\n3 0 1 2\n");
    EXPECT_TRUE(Read({spelled}, CloudFaces::kKept).mesh) << element;
  }
  const std::string points = folder.With(
      "p.ply",
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n");
  const CloudFile none = Read({points}, CloudFaces::kSampled);
  EXPECT_FALSE(none.mesh);
  EXPECT_TRUE(none.remarks.empty());
}

}  // namespace batten::internal::mesh_points_test
