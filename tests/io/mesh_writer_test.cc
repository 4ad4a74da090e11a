// SPDX-License-Identifier: MIT
// Meshes written: every vertex and triangle is in the file, in each format.
#include "batten/io/mesh_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "batten/geometry/make_surface.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "temporary_folder.h"

namespace batten {
namespace {

TriangleMesh Sphere() {
  return Tessellate(MakeSphere(Frame({1e3, 0, 0}, {0, 0, 1}), 2), {.chord_tolerance = 0.05});
}

std::string Bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

template <class Number>
Number At(const std::string& bytes, std::size_t place) {
  Number number;
  std::memcpy(&number, bytes.data() + place, sizeof number);
  return number;
}

TEST(MeshWriterTest, ObjReadsBackExactly) {
  const TriangleMesh mesh = Sphere();
  const TemporaryFolder folder;
  WriteMesh(mesh, folder.File("a.obj"));
  std::istringstream text(Bytes(folder.File("a.obj")));
  Eigen::Index vertices = 0, parameters = 0, normals = 0, triangles = 0;
  for (std::string line; std::getline(text, line);) {
    std::istringstream row(line);
    std::string word;
    row >> word;
    Eigen::Vector3d numbers = Eigen::Vector3d::Zero();
    if (word == "f") {
      for (const int vertex : mesh.triangles.col(triangles)) {
        const std::string name = std::to_string(vertex + 1);
        ASSERT_TRUE(row >> word);
        ASSERT_EQ(word, name + "/" + name + "/" + name);
      }
      ++triangles;
      continue;
    }
    for (double& number : numbers) row >> number;
    if (word == "v") {
      ASSERT_EQ(numbers, mesh.vertices.col(vertices++));
    }
    if (word == "vt") {
      ASSERT_EQ(numbers.head<2>(), mesh.parameters.col(parameters++));
    }
    if (word == "vn") {
      ASSERT_EQ(numbers, mesh.normals.col(normals++));
    }
  }
  EXPECT_EQ(vertices, mesh.vertices.cols());
  EXPECT_EQ(parameters, mesh.vertices.cols());
  EXPECT_EQ(normals, mesh.vertices.cols());
  EXPECT_EQ(triangles, mesh.triangles.cols());
}

TEST(MeshWriterTest, StlHoldsEveryTriangleInSinglePrecision) {
  const TriangleMesh mesh = Sphere();
  const TemporaryFolder folder;
  WriteMesh(mesh, folder.File("a.stl"));
  const std::string bytes = Bytes(folder.File("a.stl"));
  constexpr std::size_t kHeader = 84, kRecord = 50;
  ASSERT_EQ(bytes.size(), kHeader + kRecord * mesh.triangles.cols());
  EXPECT_NE(bytes.substr(0, 5), "solid");  // that would mean text
  EXPECT_EQ(At<std::uint32_t>(bytes, 80), mesh.triangles.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const std::size_t place = kHeader + kRecord * t;
    Eigen::Vector3f normal, corner;
    for (int k = 0; k < 3; ++k) normal[k] = At<float>(bytes, place + 4 * k);
    EXPECT_NEAR(normal.norm(), 1, 1e-6);  // floats
    for (int e = 0; e < 3; ++e) {
      const int vertex = mesh.triangles(e, t);
      for (int k = 0; k < 3; ++k) corner[k] = At<float>(bytes, place + 12 + 12 * e + 4 * k);
      ASSERT_EQ(corner, mesh.vertices.col(vertex).cast<float>());
      ASSERT_GT(normal.dot(mesh.normals.col(vertex).cast<float>()), 0);
    }
  }
}

TEST(MeshWriterTest, PlyReadsBackAsACloudAndHoldsTheTriangles) {
  const TriangleMesh mesh = Sphere();
  const TemporaryFolder folder;
  WriteMesh(mesh, folder.File("a.ply"));
  CloudReadOptions options;
  options.columns = {{"u", "u"}, {"v", "v"}};
  const PointCloud cloud = ReadCloud({folder.File("a.ply")}, options).cloud;
  ASSERT_EQ(cloud.size(), mesh.vertices.cols());
  EXPECT_EQ((cloud.points().colwise() + cloud.origin()).eval(), mesh.vertices);
  EXPECT_EQ(cloud.parameters(), mesh.parameters);
  const std::string bytes = Bytes(folder.File("a.ply"));
  constexpr std::size_t kRecord = 13;
  const std::size_t first = bytes.size() - kRecord * mesh.triangles.cols();
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    ASSERT_EQ(bytes[first + kRecord * t], 3);
    for (int e = 0; e < 3; ++e) {
      ASSERT_EQ(At<std::int32_t>(bytes, first + kRecord * t + 1 + 4 * e), mesh.triangles(e, t));
    }
  }
}

TEST(MeshWriterTest, OtherFormatsAreRefusedAndLeaveNothing) {
  const TemporaryFolder folder;
  EXPECT_THROW(WriteMesh(Sphere(), folder.File("a.glb")), UsageError);
  EXPECT_THROW(WriteMesh(Sphere(), folder.File("a")), UsageError);
  EXPECT_THROW(WriteMesh(Sphere(), "-"), UsageError);
  EXPECT_THROW(WriteMesh(Sphere(), folder.File("none/a.stl")), WriteError);
  EXPECT_EQ(folder.Entries(), 0);
  WriteMesh(Sphere(), folder.File("a"), "STL");
  EXPECT_EQ(folder.Entries(), 1);
}

}  // namespace
}  // namespace batten
