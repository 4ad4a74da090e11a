// SPDX-License-Identifier: MIT
// Faces of mesh files.
#include "batten/io/polygon_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "batten/io/mesh_writer.h"
#include "batten/io/read_error.h"
#include "temporary_folder.h"

namespace batten::internal::polygon_reader_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

template <typename Call>
std::string ErrorOf(const Call& call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(PolygonReaderTest, ReadsEveryFormatsFaces) {
  const TemporaryFolder folder;
  const std::string obj = folder.With(
      "a.obj",
      "# two\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1 2 3//4 -1\nf 1 2 3\n");
  const std::string off =
      folder.With("a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2 255 0 0\n");
  const std::string ply = folder.With(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
      "float z\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n4 0 1 2 3\n3 0 1 2\n");
  for (const std::string& path : {obj, off, ply}) {
    const PolygonMesh mesh = ReadPolygons(path);
    ASSERT_EQ(mesh.vertices.cols(), 4) << path;
    EXPECT_EQ(mesh.vertices.col(2), Eigen::Vector3d(1, 1, 0)) << path;
    ASSERT_EQ(mesh.faces.size(), 2u) << path;
    EXPECT_THAT(mesh.faces[0], ElementsAre(0, 1, 2, 3)) << path;
    EXPECT_THAT(mesh.faces[1], ElementsAre(0, 1, 2)) << path;
  }
}

TEST(PolygonReaderTest, ReadsWhatBattenWrites) {
  const TemporaryFolder folder;
  TriangleMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  mesh.parameters = Eigen::Matrix2Xd::Zero(2, 4);
  mesh.normals = Eigen::Matrix3Xd::Zero(3, 4);
  mesh.triangles.resize(3, 4);
  mesh.triangles << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
  for (const char* name : {"t.obj", "t.ply", "t.stl"}) {
    WriteMesh(mesh, folder.File(name));
    const PolygonMesh read = ReadPolygons(folder.File(name));
    EXPECT_EQ(read.vertices.cols(), 4) << name;
    ASSERT_EQ(read.faces.size(), 4u) << name;
    for (std::size_t f = 0; f < 4; ++f) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(read.vertices.col(read.faces[f][std::size_t(k)]),
                  mesh.vertices.col(mesh.triangles(k, Eigen::Index(f))));
      }
    }
  }
}

TEST(PolygonReaderTest, SaysWhereAFileIsWrong) {
  const TemporaryFolder folder;
  const auto error = [&](const char* name, const char* text) {
    const std::string path = folder.With(name, text);
    return ErrorOf([&] { ReadPolygons(path); });
  };
  EXPECT_THAT(error("a.obj", "v 0 0 0\nf 1 2 3\n"), HasSubstr("names vertex 2 of 1"));
  EXPECT_THAT(error("b.obj", "v 0 0 x\n"), HasSubstr("line 1: expected a coordinate, found 'x'"));
  EXPECT_THAT(error("c.obj", "v 0 0 0\nf 1 1\n"), HasSubstr("line 2: a face has fewer than three"));
  EXPECT_THAT(error("d.off", "OFF\n1000000000 3 0\n0 0 0\n"),
              HasSubstr("ends before its last vertex"));
  EXPECT_THAT(error("e.ply", "ply\nformat ascii 1.0\n"), HasSubstr("ends in its header"));
  EXPECT_THAT(
      error("f.ply",
            "ply\nformat binary_little_endian 1.0\nelement vertex 99999999\nproperty float x\n"
            "property float y\nproperty float z\n"
            "end_header\nab"),
      HasSubstr("ends before its last element"));
  EXPECT_THAT(error("g.ply",
                    "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\n"
                    "property float y\nend_header\n1 2\n"),
              HasSubstr("a vertex has no x, y or z"));
  const std::string triangle = folder.With("q.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(ErrorOf([&] { ReadQuadMesh(triangle); }), HasSubstr("face 1 has 3 vertices"));
  EXPECT_THROW(ReadPolygons(folder.With("a.xyz", "0 0 0\n")), UsageError);
}

}  // namespace batten::internal::polygon_reader_test
