// SPDX-License-Identifier: MIT
// Meshes written: every vertex and triangle is in the file, in each format.
#include "batten/io/mesh_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "batten/geometry/make_surface.h"
#include "batten/io/deviation_colours.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "temporary_folder.h"

namespace batten::internal::mesh_writer_test {

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

// Seams have two sides: vertices come before what the sides have.
TEST(MeshWriterTest, ObjReadsBackExactly) {
  const TriangleMesh mesh = Sphere();
  const auto vertex_count = mesh.vertices.cols();
  const auto side_count = static_cast<Eigen::Index>(mesh.other_sides.size());
  ASSERT_GT(side_count, 0);
  Eigen::Matrix3Xi sides = mesh.triangles;
  for (const SideCorner& corner : mesh.side_corners) {
    sides(corner.corner, corner.triangle) = static_cast<int>(vertex_count) + corner.side;
  }
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
      for (int e = 0; e < 3; ++e) {
        const std::string side = std::to_string(sides(e, triangles) + 1);
        ASSERT_TRUE(row >> word);
        ASSERT_EQ(word, std::to_string(mesh.triangles(e, triangles) + 1) + "/" + side + "/" + side);
      }
      ++triangles;
      continue;
    }
    for (double& number : numbers) row >> number;
    if (word == "v") {
      ASSERT_EQ(numbers, mesh.vertices.col(vertices++));
    }
    if (word == "vt") {
      const Eigen::Index k = parameters++;
      const Eigen::Vector2d expected = k < vertex_count
                                           ? Eigen::Vector2d(mesh.parameters.col(k))
                                           : mesh.other_sides[k - vertex_count].parameter;
      ASSERT_EQ(numbers.head<2>(), expected);
    }
    if (word == "vn") {
      const Eigen::Index k = normals++;
      const Eigen::Vector3d expected = k < vertex_count ? Eigen::Vector3d(mesh.normals.col(k))
                                                        : mesh.other_sides[k - vertex_count].normal;
      ASSERT_EQ(numbers, expected);
    }
  }
  EXPECT_EQ(vertices, mesh.vertices.cols());
  EXPECT_EQ(parameters, vertex_count + side_count);
  EXPECT_EQ(normals, vertex_count + side_count);
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

std::vector<SurfaceMesh> SphereAndPlane() {
  SurfaceMesh sphere{.mesh = Sphere(), .name = "a ball\nof two"};
  sphere.deviations = Eigen::VectorXd::LinSpaced(sphere.mesh.vertices.cols(), -1, 1);
  sphere.deviations[1] = std::numeric_limits<double>::quiet_NaN();
  return {sphere, {.mesh = Tessellate(MakePlane(Frame(), {0, 1}, {0, 1}))}};
}

TEST(MeshWriterTest, ObjNamesObjectsAndColoursVertices) {
  const std::vector<SurfaceMesh> meshes = SphereAndPlane();
  const TemporaryFolder folder;
  WriteMeshes(meshes, folder.File("a.obj"), {.range = 1});
  std::istringstream text(Bytes(folder.File("a.obj")));
  std::vector<std::string> names;
  std::vector<Eigen::Vector3d> places, colours;
  Eigen::Index faces = 0;
  for (std::string line; std::getline(text, line);) {
    std::istringstream row(line);
    std::string word;
    row >> word;
    if (word == "o") names.push_back(line.substr(2));
    if (word == "v") {
      std::vector<double> numbers;
      for (double number; row >> number;) numbers.push_back(number);
      ASSERT_EQ(numbers.size(), names.size() == 1 ? 6U : 3U);
      places.emplace_back(numbers[0], numbers[1], numbers[2]);
      if (numbers.size() == 6) colours.emplace_back(numbers[3], numbers[4], numbers[5]);
    }
    if (word != "f") continue;
    ++faces;
    while (row >> word) {
      // Counted through the file, so that the second object's vertices are its own.
      const std::size_t vertex = std::stoul(word);
      ASSERT_LE(vertex, places.size());
      ASSERT_GT(vertex,
                names.size() == 1 ? 0U : static_cast<std::size_t>(meshes[0].mesh.vertices.cols()));
    }
  }
  EXPECT_EQ(names, (std::vector<std::string>{"a_ball_of_two", "surface-2"}));
  EXPECT_EQ(faces, meshes[0].mesh.triangles.cols() + meshes[1].mesh.triangles.cols());
  const RgbColumns expected = DeviationColours(meshes[0].deviations, 1);
  ASSERT_EQ(static_cast<Eigen::Index>(colours.size()), expected.cols());
  for (std::size_t k = 0; k < colours.size(); ++k) {
    const Eigen::Vector3d colour = expected.col(static_cast<Eigen::Index>(k)).cast<double>();
    ASSERT_LE((255 * colours[k] - colour).cwiseAbs().maxCoeff(), 0.05);  // four digits
  }
}

TEST(MeshWriterTest, PlyHoldsColoursDeviationsAndWhetherThereAreAny) {
  const std::vector<SurfaceMesh> meshes = SphereAndPlane();
  const TemporaryFolder folder;
  WriteMeshes(meshes, folder.File("a.ply"), {.range = 1});
  const CloudFile file = ReadCloud({folder.File("a.ply")});
  const Eigen::Index first = meshes[0].mesh.vertices.cols(), count = first + 4;
  ASSERT_EQ(file.cloud.size(), count);
  EXPECT_EQ(file.cloud.colours().leftCols(first), DeviationColours(meshes[0].deviations, 1));
  CloudReadOptions unmeasured, deviating;
  unmeasured.where = {{"measured", 0}};
  EXPECT_EQ(ReadCloud({folder.File("a.ply")}, unmeasured).cloud.size(), 5);
  deviating.columns = {{"w", "measured"}, {"x", "deviation"}, {"y", "x"}, {"z", "y"}};
  deviating.where = {{"measured", 1}};
  const PointCloud read = ReadCloud({folder.File("a.ply")}, deviating).cloud;
  ASSERT_EQ(read.size(), first - 1);
  EXPECT_EQ(read.World(0)[0], -1);
  EXPECT_EQ(read.World(first - 2)[0], 1);
  // The second mesh's triangles are of its own vertices.
  const std::string bytes = Bytes(folder.File("a.ply"));
  EXPECT_GE(At<std::int32_t>(bytes, bytes.size() - 12), first);
}

TEST(MeshWriterTest, StlRefusesDeviations) {
  const TemporaryFolder folder;
  EXPECT_THROW(WriteMeshes(SphereAndPlane(), folder.File("a.stl")), UsageError);
  EXPECT_EQ(folder.Entries(), 0);
}

TEST(MeshWriterTest, OtherFormatsAreRefusedAndLeaveNothing) {
  const TemporaryFolder folder;
  EXPECT_THROW(WriteMesh(Sphere(), folder.File("a.gltf")), UsageError);
  EXPECT_THROW(WriteMesh(Sphere(), folder.File("a")), UsageError);
  EXPECT_THROW(WriteMesh(Sphere(), "-"), UsageError);
  EXPECT_THROW(WriteMesh(Sphere(), folder.File("none/a.stl")), WriteError);
  EXPECT_EQ(folder.Entries(), 0);
  WriteMesh(Sphere(), folder.File("a"), "STL");
  EXPECT_EQ(folder.Entries(), 1);
}

}  // namespace batten::internal::mesh_writer_test
