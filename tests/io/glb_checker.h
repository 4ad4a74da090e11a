// SPDX-License-Identifier: MIT
// A strict reader of GLB files: what the specification demands and viewers rely on, asserted.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace batten::internal {

// A mesh as a viewer shows it: vertices in the scene's frame.
struct GlbMesh {
  std::string name;
  Eigen::Matrix3Xd vertices, normals;
  Eigen::Matrix2Xd texture;
  Eigen::Matrix4Xd colours;  // 0 … 1, linear; no columns where there are none
  Eigen::Matrix3Xi triangles;
  bool double_sided = false;
  int index_bytes = 0;
};

class GlbChecker {
 public:
  explicit GlbChecker(std::string bytes) : bytes_(std::move(bytes)) {}

  // What the file shows; failures of the test where it breaks a rule.
  std::vector<GlbMesh> Meshes() {
    if (!Chunks()) return {};
    EXPECT_EQ(document_["asset"]["version"], "2.0");
    EXPECT_EQ(document_["buffers"].size(), 1U);
    const auto promised = document_["buffers"][0]["byteLength"].get<std::size_t>();
    EXPECT_FALSE(document_["buffers"][0].contains("uri"));
    EXPECT_LE(promised, binary_.size());
    EXPECT_LE(binary_.size(), promised + 3);
    for (const char* list : {"meshes", "materials", "accessors", "bufferViews", "nodes"}) {
      EXPECT_TRUE(document_[list].is_array() && !document_[list].empty()) << list;
    }
    std::size_t end = 0;  // views do not overlap
    for (const auto& view : document_["bufferViews"]) {
      EXPECT_EQ(view["buffer"], 0);
      const auto offset = view["byteOffset"].get<std::size_t>();
      const auto length = view["byteLength"].get<std::size_t>();
      EXPECT_GE(offset, end);
      EXPECT_EQ(offset % 4, 0U);
      EXPECT_GT(length, 0U);
      end = offset + length;
      EXPECT_LE(end, promised);
      EXPECT_FALSE(view.contains("byteStride"));
    }
    const auto& scene = document_["scenes"][document_["scene"].get<std::size_t>()];
    for (const auto& node : scene["nodes"]) {
      Walk(node.get<std::size_t>(), Eigen::Affine3d::Identity());
    }
    EXPECT_EQ(seen_nodes_.size(), document_["nodes"].size());
    EXPECT_EQ(seen_views_.size(), document_["bufferViews"].size());
    EXPECT_EQ(meshes_.size(), document_["meshes"].size());
    return meshes_;
  }

 private:
  std::uint32_t Word(std::size_t place) const {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes_.at(place + k)))
              << (8 * k);
    }
    return word;
  }

  bool Chunks() {
    if (bytes_.size() < 20) return ADD_FAILURE() << "too short", false;
    EXPECT_EQ(bytes_.substr(0, 4), "glTF");
    EXPECT_EQ(Word(4), 2U);
    EXPECT_EQ(Word(8), bytes_.size());
    const std::size_t text = Word(12);
    EXPECT_EQ(text % 4, 0U);
    EXPECT_EQ(bytes_.substr(16, 4), "JSON");
    if (bytes_.size() < 28 + text) return ADD_FAILURE() << "no second chunk", false;
    EXPECT_EQ(Word(20 + text) % 4, 0U);
    EXPECT_EQ(bytes_.substr(24 + text, 4), std::string("BIN\0", 4));
    EXPECT_EQ(28 + text + Word(20 + text), bytes_.size());
    document_ = nlohmann::json::parse(bytes_.substr(20, text));
    binary_ = bytes_.substr(28 + text);
    return true;
  }

  void Walk(std::size_t number, const Eigen::Affine3d& frame) {
    EXPECT_TRUE(seen_nodes_.insert(number).second) << "a node with two parents";
    const auto& node = document_["nodes"].at(number);
    Eigen::Affine3d here = frame;
    if (node.contains("translation")) {
      const auto t = node["translation"].get<std::vector<double>>();
      here.translate(Eigen::Vector3d(t.at(0), t.at(1), t.at(2)));
    }
    if (node.contains("rotation")) {
      const auto q = node["rotation"].get<std::vector<double>>();
      const Eigen::Quaterniond turn(q.at(3), q.at(0), q.at(1), q.at(2));
      EXPECT_NEAR(turn.norm(), 1, 1e-12);
      here.rotate(turn);
    }
    if (node.contains("scale")) {
      const auto s = node["scale"].get<std::vector<double>>();
      here.scale(Eigen::Vector3d(s.at(0), s.at(1), s.at(2)));
    }
    if (node.contains("mesh")) Show(node["mesh"].get<std::size_t>(), node["name"], here);
    if (!node.contains("children")) return;
    EXPECT_FALSE(node["children"].empty());
    for (const auto& child : node["children"]) Walk(child.get<std::size_t>(), here);
  }

  // The numbers of an accessor, one column an element, normalised ones as shares.
  Eigen::MatrixXd Read(std::size_t number, const std::string& type, int target) {
    static const std::map<std::string, Eigen::Index> kParts{
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
    static const std::map<int, std::size_t> kBytes{{5121, 1}, {5123, 2}, {5125, 4}, {5126, 4}};
    const auto& accessor = document_["accessors"].at(number);
    EXPECT_EQ(accessor["type"], type);
    const int component = accessor["componentType"];
    const std::size_t bytes = kBytes.at(component);
    const Eigen::Index parts = kParts.at(type), count = accessor["count"];
    const auto view_number = accessor["bufferView"].get<std::size_t>();
    seen_views_.insert(view_number);
    const auto& view = document_["bufferViews"].at(view_number);
    EXPECT_EQ(view["target"], target);
    const std::size_t offset =
        view["byteOffset"].get<std::size_t>() + accessor.value("byteOffset", std::size_t{0});
    EXPECT_EQ(offset % bytes, 0U);
    if (target == 34962) {
      EXPECT_EQ(static_cast<std::size_t>(parts) * bytes % 4, 0U) << "vertices start at fours";
    }
    EXPECT_EQ(static_cast<std::size_t>(parts * count) * bytes,
              view["byteLength"].get<std::size_t>());
    Eigen::MatrixXd values(parts, count);
    const char* from = binary_.data() + offset;
    for (double& value : values.reshaped()) {
      value = component == 5126   ? Number<float>(from)
              : component == 5125 ? Number<std::uint32_t>(from)
              : component == 5123 ? Number<std::uint16_t>(from)
                                  : Number<std::uint8_t>(from);
      from += bytes;
    }
    EXPECT_TRUE(values.allFinite());
    if (accessor.value("normalized", false))
      values /= std::exp2(8.0 * static_cast<double>(bytes)) - 1;
    if (accessor.contains("min")) {
      for (Eigen::Index k = 0; k < parts; ++k) {
        EXPECT_EQ(values.row(k).minCoeff(), accessor["min"][k].get<double>());
        EXPECT_EQ(values.row(k).maxCoeff(), accessor["max"][k].get<double>());
      }
    }
    index_bytes_ = static_cast<int>(bytes);
    return values;
  }

  template <class T>
  static double Number(const char* from) {
    T number;
    std::memcpy(&number, from, sizeof number);
    return static_cast<double>(number);
  }

  void Show(std::size_t number, const std::string& name, const Eigen::Affine3d& frame) {
    constexpr int kVertices = 34962, kIndices = 34963;
    const auto& mesh = document_["meshes"].at(number);
    EXPECT_EQ(mesh["primitives"].size(), 1U);
    const auto& primitive = mesh["primitives"][0];
    const auto& attributes = primitive["attributes"];
    EXPECT_TRUE(document_["accessors"][attributes["POSITION"].get<std::size_t>()].contains("min"));
    GlbMesh shown;
    shown.name = name;
    const Eigen::Matrix3Xd positions = Read(attributes["POSITION"], "VEC3", kVertices);
    shown.vertices = frame * positions;
    shown.normals = Read(attributes["NORMAL"], "VEC3", kVertices);
    for (auto normal : shown.normals.colwise()) {
      EXPECT_NEAR(normal.norm(), 1, 5e-4);  // what the Khronos validator grants
      normal = (frame.linear() * normal).normalized();
    }
    shown.texture = Read(attributes["TEXCOORD_0"], "VEC2", kVertices);
    if (attributes.contains("COLOR_0")) {
      shown.colours = Read(attributes["COLOR_0"], "VEC4", kVertices);
      EXPECT_EQ(shown.colours.cols(), shown.vertices.cols());
    }
    EXPECT_EQ(shown.normals.cols(), shown.vertices.cols());
    EXPECT_EQ(shown.texture.cols(), shown.vertices.cols());
    const Eigen::MatrixXd indices = Read(primitive["indices"], "SCALAR", kIndices);
    shown.index_bytes = index_bytes_;
    EXPECT_EQ(indices.size() % 3, 0);
    EXPECT_LT(indices.maxCoeff(), static_cast<double>(shown.vertices.cols()));
    EXPECT_LT(indices.maxCoeff(), std::exp2(8.0 * index_bytes_) - 1) << "the reserved index";
    shown.triangles = indices.reshaped(3, indices.size() / 3).cast<int>();
    const auto& material = document_["materials"].at(primitive["material"].get<std::size_t>());
    shown.double_sided = material.value("doubleSided", false);
    meshes_.push_back(std::move(shown));
  }

  std::string bytes_, binary_;
  nlohmann::json document_;
  std::set<std::size_t> seen_nodes_, seen_views_;
  std::vector<GlbMesh> meshes_;
  int index_bytes_ = 0;
};

}  // namespace batten::internal
