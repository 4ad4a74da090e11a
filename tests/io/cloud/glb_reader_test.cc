// SPDX-License-Identifier: MIT
// The triangles of GLB files, those that batten writes and others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batten/geometry/make_surface.h"
#include "batten/geometry/tessellate.h"
#include "batten/io/mesh_writer.h"
#include "batten/io/polygon_reader.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "io/base/little_endian.h"
#include "io/cloud/polygon_text.h"
#include "temporary_folder.h"

namespace batten::internal::glb_reader_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr double kVertices[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 3, 4}};

std::string Bytes() {
  std::string bytes;
  for (const auto& vertex : kVertices) {
    for (const double x : vertex) AppendLittleEndian(bytes, static_cast<float>(x));
  }
  for (const int index : {0, 1, 2, 2, 1, 3, 3, 4}) AppendLittleEndian<std::uint16_t>(bytes, index);
  return bytes;
}

Json Document() {
  return Json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "buffers": [{"byteLength": 76}],
    "bufferViews": [{"buffer": 0, "byteLength": 60}, {"buffer": 0, "byteOffset": 60, "byteLength": 16}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}]})");
}

std::string GlbOf(std::string text) {
  std::string bytes = Bytes(), glb = "glTF";
  text.resize((text.size() + 3) / 4 * 4, ' ');
  AppendLittleEndian<std::uint32_t>(glb, 2);
  AppendLittleEndian(glb, static_cast<std::uint32_t>(28 + text.size() + bytes.size()));
  AppendLittleEndian(glb, static_cast<std::uint32_t>(text.size()));
  AppendLittleEndian<std::uint32_t>(glb, 0x4E4F534A);
  glb += text;
  AppendLittleEndian(glb, static_cast<std::uint32_t>(bytes.size()));
  AppendLittleEndian<std::uint32_t>(glb, 0x004E4942);
  return glb + bytes;
}

std::string Glb(const Json& document) { return GlbOf(document.dump()); }

PolygonMesh Read(const Json& document) { return PolygonsOfText(Glb(document), ".glb", "a.glb"); }

// Of glTF's frame, y up.
Eigen::Vector3d Upright(const Eigen::Vector3d& p) { return {p.x(), -p.z(), p.y()}; }

TEST(GlbReaderTest, ReadsWhatBattenWrites) {
  const TemporaryFolder folder;
  const TriangleMesh mesh =
      Tessellate(MakeSphere(Frame({10, 20, 30}, {0, 0, 1}), 2), {.chord_tolerance = 0.1});
  const std::string path = folder.File("ball.glb");
  WriteMeshes({{.mesh = mesh}}, path, {.metres = 1});
  const PolygonMesh read = ReadPolygons(path);
  ASSERT_EQ(std::ssize(read.faces), mesh.triangles.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT((read.vertices.col(read.faces[std::size_t(t)][std::size_t(k)]) -
                 mesh.vertices.col(mesh.triangles(k, t)))
                    .norm(),
                1e-5);
    }
  }
  CloudReadOptions options;
  options.faces = CloudFaces::kKept;
  const CloudFile file = ReadCloud({path}, options);
  EXPECT_EQ(file.cloud.size(), read.vertices.cols());
  ASSERT_TRUE(file.mesh);
  EXPECT_EQ(file.mesh->faces.open_edges, 0);
  ASSERT_EQ(file.remarks.size(), 1U);
  EXPECT_THAT(file.remarks[0], HasSubstr("in metres"));
}

// Nodes put meshes where their matrix does, or their scale, rotation and translation in this order.
TEST(GlbReaderTest, NodesPlaceWhatTheyHold) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 2) / 3));
  const Eigen::Vector3d shift(5, -1, 2), scale(2, 1, 0.5);
  Eigen::Affine3d place = Eigen::Affine3d::Identity();
  place.translate(shift).rotate(turn).scale(scale);
  Json parts = Document(), matrix = Document();
  parts["nodes"] = Json::array({{{"children", {1}}, {"translation", {5, -1, 2}}},
                                {{"mesh", 0},
                                 {"rotation", {turn.x(), turn.y(), turn.z(), turn.w()}},
                                 {"scale", {2, 1, 0.5}}}});
  matrix["nodes"][0]["matrix"] =
      std::vector<double>(place.matrix().data(), place.matrix().data() + 16);
  for (const Json& document : {parts, matrix}) {
    const PolygonMesh read = Read(document);
    ASSERT_EQ(read.faces.size(), 2U);
    EXPECT_THAT(read.faces[0], ElementsAre(0, 1, 2));
    EXPECT_THAT(read.faces[1], ElementsAre(2, 1, 3));
    for (Eigen::Index k = 0; k < read.vertices.cols(); ++k) {
      const Eigen::Vector3d given(kVertices[k]);
      EXPECT_LT((read.vertices.col(k) - Upright(place * given)).norm(), 1e-12);
    }
  }
}

TEST(GlbReaderTest, StripsAndFansAreTriangles) {
  Json document = Document();
  Json& primitive = document["meshes"][0]["primitives"][0];
  document["accessors"][1]["count"] = 8;
  primitive["mode"] = 5;  // 0 1 2, 2 1 3 and 3 4: triangles of two corners alike are none
  EXPECT_THAT(Read(document).faces, ElementsAre(ElementsAre(0, 1, 2), ElementsAre(2, 3, 1)));
  document["accessors"][1]["count"] = 3;
  primitive["mode"] = 6;
  EXPECT_THAT(Read(document).faces, ElementsAre(ElementsAre(0, 1, 2)));
  primitive.erase("indices");
  EXPECT_THAT(Read(document).faces,
              ElementsAre(ElementsAre(0, 1, 2), ElementsAre(0, 2, 3), ElementsAre(0, 3, 4)));
  primitive["mode"] = 0;
  const PolygonMesh points = Read(document);
  EXPECT_TRUE(points.faces.empty());
  EXPECT_EQ(points.vertices.cols(), 5);
}

// Primitives share what an accessor holds; components and steps between vertices are of any size;
// what a node mirrors keeps its outside.
TEST(GlbReaderTest, TakesWhatIndicesNameOfAnAccessor) {
  Json document = Document();
  document["accessors"][1]["count"] = 3;
  EXPECT_EQ(Read(document).vertices.cols(), 3);
  document["nodes"][0]["scale"] = {-1, 1, 1};
  EXPECT_THAT(Read(document).faces, ElementsAre(ElementsAre(0, 2, 1)));
  Json bytes = Document();
  bytes["accessors"][1] = {{"bufferView", 1},
                           {"byteOffset", 2},
                           {"componentType", 5121},
                           {"count", 3},
                           {"type", "SCALAR"}};
  const PolygonMesh small = Read(bytes);  // 1 0 2 of the bytes of 0 1 2, 16 bits each
  EXPECT_THAT(small.faces, ElementsAre(ElementsAre(0, 1, 2)));
  EXPECT_EQ(small.vertices.col(0), Upright(Eigen::Vector3d(1, 0, 0)));
  Json wide = Document();
  wide["bufferViews"][0]["byteStride"] = 24;
  wide["accessors"][0]["count"] = 3;
  wide["meshes"][0]["primitives"][0].erase("indices");
  const PolygonMesh every_other = Read(wide);
  ASSERT_EQ(every_other.vertices.cols(), 3);
  EXPECT_EQ(every_other.vertices.col(1), Upright(Eigen::Vector3d(0, 1, 0)));
  EXPECT_EQ(every_other.vertices.col(2), Upright(Eigen::Vector3d(2, 3, 4)));
}

// A short file can't take memory or the stack.
TEST(GlbReaderTest, RefusesWhatIsPlacedTooOften) {
  Json document = Document();
  for (int k = 0; k < 2000; ++k)
    document["meshes"][0]["primitives"].push_back(document["meshes"][0]["primitives"][0]);
  EXPECT_EQ(Read(document).faces.size(), 2 * 2001U);
  // The text of a document whose type, or extension, is nested deep.
  const std::string nested = std::string(200000, '[') + std::string(200000, ']');
  const auto with = [&](const std::string& word, const std::string& instead) {
    std::string text = Document().dump();
    text.replace(text.find(word), word.size(), instead);
    return GlbOf(text);
  };
  for (const std::string& glb :
       {with(R"("type":"VEC3")", R"("type":)" + nested),
        with(R"("scene":0)", R"("scene":0,"extensionsRequired":[)" + nested + "]")}) {
    EXPECT_THROW(PolygonsOfText(glb, ".glb", "a.glb"), ReadError);
  }
}

TEST(GlbReaderTest, SaysWhatItDoesNotRead) {
  const auto error = [](const std::function<void(Json&)>& change) -> std::string {
    Json document = Document();
    change(document);
    try {
      Read(document);
    } catch (const ReadError& refusal) {
      return refusal.what();
    }
    return "";
  };
  EXPECT_EQ(error([](Json&) {}), "");
  EXPECT_THAT(error([](Json& d) { d["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }),
              HasSubstr("needs KHR_draco_mesh_compression, which is not read"));
  EXPECT_EQ(error([](Json& d) { d["extensionsRequired"] = {"KHR_materials_unlit"}; }), "");
  EXPECT_THAT(error([](Json& d) { d["buffers"][0]["uri"] = "far.bin"; }),
              HasSubstr("accessors[0] is in another file"));
  EXPECT_THAT(error([](Json& d) { d["accessors"][0]["sparse"] = Json::object(); }),
              HasSubstr("accessors[0] is sparse"));
  EXPECT_THAT(error([](Json& d) { d["accessors"][0]["count"] = 6; }),
              HasSubstr("promises 6 items of 12 bytes, beyond the 76 bytes"));
  EXPECT_THAT(error([](Json& d) {
                d["accessors"][0]["count"] = 4;
                d["accessors"][1]["count"] = 8;
              }),
              HasSubstr("accessors[1]: index 7 names vertex 4 of 4"));
  EXPECT_THAT(error([](Json& d) { d["nodes"][0]["children"] = {0}; }),
              HasSubstr("nodes[0] has several parents"));
  EXPECT_THAT(error([](Json& d) { d["nodes"][0]["mesh"] = 3; }),
              HasSubstr("meshes[3] is named and not there"));
  EXPECT_THAT(error([](Json& d) {
                d["nodes"][0]["scale"] = {1, 2};
              }),
              HasSubstr("scale of a node is not 3 finite numbers"));
  const auto bytes_error = [](const std::string& bytes) -> std::string {
    try {
      PolygonsOfText(bytes, ".glb", "a.glb");
    } catch (const ReadError& refusal) {
      return refusal.what();
    }
    return "";
  };
  const std::string whole = Glb(Document());
  EXPECT_THAT(bytes_error("glt"), HasSubstr("byte 0: is no .glb file"));
  EXPECT_THAT(bytes_error(whole.substr(0, 40)), HasSubstr("a chunk of JSON of"));
  EXPECT_THAT(bytes_error(whole.substr(0, whole.size() - 1)), HasSubstr("a chunk of bytes of 76"));
  EXPECT_EQ(bytes_error(whole + "what follows is not of the file"), "");
  std::string old = whole;
  old[4] = 1;
  EXPECT_THAT(bytes_error(old), HasSubstr("is of version 1"));
}

}  // namespace batten::internal::glb_reader_test
