// SPDX-License-Identifier: MIT
// GLB files: by the specification, and the mesh that was given.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/make_surface.h"
#include "batten/io/deviation_colours.h"
#include "batten/io/mesh_writer.h"
#include "glb_checker.h"
#include "temporary_folder.h"

namespace batten::internal::glb_writer_test {

std::vector<GlbMesh> Written(const std::vector<SurfaceMesh>& meshes,
                             const MeshWriteOptions& options = {}) {
  const TemporaryFolder folder;
  WriteMeshes(meshes, folder.File("a.glb"), options);
  std::ifstream file(folder.File("a.glb"), std::ios::binary);
  return GlbChecker({std::istreambuf_iterator<char>(file), {}}).Meshes();
}

// From glTF's frame, y up, back to that of the data.
Eigen::Matrix3Xd ZUp(const Eigen::Matrix3Xd& points) {
  Eigen::Matrix3Xd turned(3, points.cols());
  turned << points.row(0), -points.row(2), points.row(1);
  return turned;
}

// Corner by corner: vertices on seams may be doubled.
void ExpectSameTriangles(const GlbMesh& shown, const TriangleMesh& mesh, double metres) {
  ASSERT_EQ(shown.triangles.cols(), mesh.triangles.cols());
  const Eigen::Matrix3Xd places = ZUp(shown.vertices) / metres, normals = ZUp(shown.normals);
  const double size =
      (mesh.vertices.rowwise().maxCoeff() - mesh.vertices.rowwise().minCoeff()).norm();
  // Beside a float's half step, doubles far from the origin have their own.
  const double rounding = 1e-15 * mesh.vertices.cwiseAbs().maxCoeff();
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (int e = 0; e < 3; ++e) {
      const int here = shown.triangles(e, t), there = mesh.triangles(e, t);
      ASSERT_LE((places.col(here) - mesh.vertices.col(there)).norm(), 1e-7 * size + rounding);
      ASSERT_GT(normals.col(here).dot(mesh.normals.col(there)), 0.5);
    }
  }
}

TEST(GlbWriterTest, HoldsTheMeshInMetresWithYUp) {
  const TriangleMesh mesh =
      Tessellate(MakeSphere(Frame({10, 20, 30}, {0, 0, 1}), 2), {.chord_tolerance = 0.01});
  for (const double metres : {1e-3, 0.0254, 1.0}) {
    const auto shown = Written({{.mesh = mesh}}, {.metres = metres});
    ASSERT_EQ(shown.size(), 1U);
    EXPECT_TRUE(shown[0].double_sided);
    EXPECT_EQ(shown[0].name, "surface-1");
    ExpectSameTriangles(shown[0], mesh, metres);
  }
}

TEST(GlbWriterTest, CoordinatesFarFromTheOriginKeepTheirDigits) {
  const Eigen::Vector3d utm(500123.25, 5412345.5, 312.75);
  const TriangleMesh mesh =
      Tessellate(MakeTorus(Frame(utm, {0, 0, 1}), 20, 5), {.chord_tolerance = 0.01});
  const auto shown = Written({{.mesh = mesh}}, {.metres = 1});
  ASSERT_EQ(shown.size(), 1U);
  ExpectSameTriangles(shown[0], mesh, 1);
}

TEST(GlbWriterTest, TextureCoordinatesAreTheDomainAndSeamsHaveBothTheirSides) {
  const NurbsSurface cylinder = MakeCylinder(Frame(), 1, {0, 5});
  const TriangleMesh mesh = Tessellate(cylinder, {.chord_tolerance = 1e-3});
  const Eigen::AlignedBox2d domain(
      Eigen::Vector2d(cylinder.basis_u().lower(), cylinder.basis_v().lower()),
      Eigen::Vector2d(cylinder.basis_u().upper(), cylinder.basis_v().upper()));
  const auto shown = Written({{.mesh = mesh, .domain = domain}}, {.metres = 1});
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_GT(shown[0].vertices.cols(), mesh.vertices.cols());
  const Eigen::Matrix3Xd places = ZUp(shown[0].vertices);
  for (Eigen::Index k = 0; k < places.cols(); ++k) {
    const Eigen::Vector2d at =
        domain.min().array() + shown[0].texture.col(k).array() * domain.sizes().array();
    EXPECT_LE((cylinder.At(at[0], at[1]) - places.col(k)).norm(), 1e-5);  // floats
  }
  // No triangle reaches over more than a quarter of the way round, as texture or in space.
  for (const auto triangle : shown[0].triangles.colwise()) {
    for (int e = 0; e < 3; ++e) {
      const Eigen::Vector2d along =
          shown[0].texture.col(triangle[(e + 1) % 3]) - shown[0].texture.col(triangle[e]);
      EXPECT_LE(std::abs(along[0]), 0.26);
    }
  }
}

TEST(GlbWriterTest, SurfacesAreObjectsOfTheirNames) {
  const TriangleMesh sphere = Tessellate(MakeSphere(Frame(), 1)),
                     plane = Tessellate(MakePlane(Frame({5, 5, 5}, {1, 0, 0}), {0, 1}, {0, 2}));
  const auto shown = Written({{.mesh = sphere, .name = "kn\xC3\xB6pfe \"A\"\n"},
                              {.mesh = plane},
                              {.mesh = sphere, .name = "\xFF"}});
  ASSERT_EQ(shown.size(), 3U);
  EXPECT_EQ(shown[0].name, "kn\xC3\xB6pfe \"A\"\n");
  EXPECT_EQ(shown[1].name, "surface-2");
  EXPECT_EQ(shown[2].name, "\xEF\xBF\xBD");  // what is no UTF-8 is replaced
  ExpectSameTriangles(shown[0], sphere, 1e-3);
  ExpectSameTriangles(shown[1], plane, 1e-3);
}

TEST(GlbWriterTest, ColoursAreTheDeviationsLinear) {
  SurfaceMesh plane{.mesh = Tessellate(MakePlane(Frame(), {0, 1}, {0, 1}))};
  plane.deviations = Eigen::Vector4d(-0.1, 0, 0.1, std::numeric_limits<double>::quiet_NaN());
  const auto shown = Written({plane}, {.range = 0.1});
  ASSERT_EQ(shown.size(), 1U);
  ASSERT_EQ(shown[0].colours.cols(), 4);
  for (Eigen::Index k = 0; k < 4; ++k) {
    const Rgb colour = DeviationColour(plane.deviations[k], 0.1);
    for (int part = 0; part < 3; ++part) {
      const double linear = shown[0].colours(part, k);
      const double srgb =
          linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
      EXPECT_EQ(std::lround(255 * srgb), colour[part]);
    }
    EXPECT_EQ(shown[0].colours(3, k), 1);
  }
}

TEST(GlbWriterTest, IndicesAreShortUpTo65535Vertices) {
  for (const Eigen::Index count : {65535, 65536}) {
    // A fan; its vertices need not differ much.
    TriangleMesh mesh;
    mesh.vertices = Eigen::Matrix3Xd::Random(3, count);
    mesh.parameters = Eigen::Matrix2Xd::Random(2, count);
    mesh.normals = Eigen::Matrix3Xd::Zero(3, count);
    mesh.normals.row(2).setOnes();
    mesh.triangles.resize(3, count - 2);
    for (Eigen::Index t = 0; t < count - 2; ++t) mesh.triangles.col(t) << 0, t + 1, t + 2;
    const auto shown = Written({{.mesh = mesh}});
    ASSERT_EQ(shown.size(), 1U);
    EXPECT_EQ(shown[0].index_bytes, count == 65535 ? 2 : 4);
    EXPECT_EQ(shown[0].triangles, mesh.triangles);
  }
}

TEST(GlbWriterTest, NothingToShowIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(WriteMeshes({}, folder.File("a.glb")), std::invalid_argument);
  SurfaceMesh plane{.mesh = Tessellate(MakePlane(Frame(), {0, 1}, {0, 1}))};
  EXPECT_THROW(WriteMeshes({plane}, folder.File("a.glb"), {.metres = 0}), std::invalid_argument);
  plane.deviations = Eigen::Vector2d(0, 1);
  EXPECT_THROW(WriteMeshes({plane}, folder.File("a.glb")), std::invalid_argument);
  EXPECT_EQ(folder.Entries(), 0);
}

}  // namespace batten::internal::glb_writer_test
