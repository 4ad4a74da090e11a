// SPDX-License-Identifier: MIT
#include "io/mesh/glb_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <utility>

#include "batten/io/read_error.h"
#include "io/base/little_endian.h"
#include "io/cloud/glb_words.h"

namespace batten::internal {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVertexData = 34962, kIndexData = 34963;
constexpr Eigen::Index kMostShort = 65535;  // vertices: the index 65535 itself is reserved

// A mesh with a vertex for every corner of its own: those on seams and creases are doubled.
struct Corners {
  std::vector<int> vertices;  // of the mesh, for each vertex written
  Eigen::Matrix2Xd parameters;
  Eigen::Matrix3Xd normals;
  Eigen::Matrix3Xi triangles;
};

Corners CornersOf(const TriangleMesh& mesh) {
  Corners corners;
  const auto count = static_cast<int>(mesh.vertices.cols());
  const auto extra = static_cast<Eigen::Index>(mesh.other_sides.size());
  for (int k = 0; k < count; ++k) corners.vertices.push_back(k);
  corners.parameters.resize(2, count + extra);
  corners.normals.resize(3, count + extra);
  corners.parameters.leftCols(count) = mesh.parameters;
  corners.normals.leftCols(count) = mesh.normals;
  corners.triangles = mesh.triangles;
  for (Eigen::Index k = 0; k < extra; ++k) {
    const OtherSide& side = mesh.other_sides[static_cast<std::size_t>(k)];
    corners.vertices.push_back(side.vertex);
    corners.parameters.col(count + k) = side.parameter;
    corners.normals.col(count + k) = side.normal;
  }
  for (const SideCorner& corner : mesh.side_corners) {
    corners.triangles(corner.corner, corner.triangle) = count + corner.side;
  }
  return corners;
}

// A stretch of the binary chunk, and what it means.
struct Stretch {
  Json accessor;
  int target;
  std::string bytes;
};

Json NumbersOf(const Eigen::VectorXd& numbers) {
  return std::vector<double>(numbers.begin(), numbers.end());
}

Stretch Positions(const TriangleMesh& mesh, const Corners& corners, const Eigen::Vector3d& middle) {
  Stretch positions{{}, kVertexData, {}};
  Eigen::Vector3f lower = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity());
  Eigen::Vector3f upper = -lower;
  for (const int vertex : corners.vertices) {
    const Eigen::Vector3f place = (mesh.vertices.col(vertex) - middle).cast<float>();
    lower = lower.cwiseMin(place);
    upper = upper.cwiseMax(place);
    AppendAllLittleEndian<float>(positions.bytes, place);
  }
  positions.accessor = {{"componentType", kFloat},
                        {"count", corners.vertices.size()},
                        {"type", "VEC3"},
                        {"min", NumbersOf(lower.cast<double>())},
                        {"max", NumbersOf(upper.cast<double>())}};
  return positions;
}

Stretch Normals(const Corners& corners) {
  constexpr double kUnit = 0.5;  // what is shorter is no normal
  Stretch normals{{}, kVertexData, {}};
  for (const auto normal : corners.normals.colwise()) {
    const bool sound = normal.allFinite() && normal.norm() > kUnit;
    const Eigen::Vector3d written = sound ? normal.normalized() : Eigen::Vector3d::UnitZ();
    AppendAllLittleEndian<float>(normals.bytes, written);
  }
  normals.accessor = {
      {"componentType", kFloat}, {"count", corners.vertices.size()}, {"type", "VEC3"}};
  return normals;
}

Stretch TextureCoordinates(const SurfaceMesh& surface, const Corners& corners) {
  Eigen::AlignedBox2d domain = surface.domain;
  if (domain.isEmpty()) {
    for (const auto parameter : corners.parameters.colwise())
      domain.extend(Eigen::Vector2d(parameter));
  }
  const Eigen::Array2d size = domain.sizes().array().max(std::numeric_limits<double>::min());
  Stretch texture{{}, kVertexData, {}};
  for (const auto parameter : corners.parameters.colwise()) {
    const Eigen::Array2d share = (parameter - domain.min()).array() / size;
    AppendAllLittleEndian<float>(texture.bytes, share.max(0.0).min(1.0).eval());
  }
  texture.accessor = {
      {"componentType", kFloat}, {"count", corners.vertices.size()}, {"type", "VEC2"}};
  return texture;
}

// glTF's vertex colours are linear. [IEC 61966-2-1]
std::uint16_t LinearOf(std::uint8_t srgb) {
  const double value = srgb / 255.0;
  const double linear = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  return static_cast<std::uint16_t>(
      std::lround(linear * std::numeric_limits<std::uint16_t>::max()));
}

// With a fourth component, opaque, that keeps every vertex at a multiple of four bytes.
Stretch Colours(const RgbColumns& colours, const Corners& corners) {
  Stretch written{{}, kVertexData, {}};
  std::array<std::uint16_t, 256> linear;
  for (std::size_t k = 0; k < linear.size(); ++k)
    linear[k] = LinearOf(static_cast<std::uint8_t>(k));
  for (const int vertex : corners.vertices) {
    for (const std::uint8_t part : colours.col(vertex))
      AppendLittleEndian(written.bytes, linear[part]);
    AppendLittleEndian(written.bytes, std::numeric_limits<std::uint16_t>::max());
  }
  written.accessor = {{"componentType", kUnsignedShort},
                      {"normalized", true},
                      {"count", corners.vertices.size()},
                      {"type", "VEC4"}};
  return written;
}

Stretch Indices(const Corners& corners) {
  const bool shorts = static_cast<Eigen::Index>(corners.vertices.size()) <= kMostShort;
  Stretch indices{{}, kIndexData, {}};
  for (const int vertex : corners.triangles.reshaped()) {
    if (shorts) {
      AppendLittleEndian(indices.bytes, static_cast<std::uint16_t>(vertex));
    } else {
      AppendLittleEndian(indices.bytes, static_cast<std::uint32_t>(vertex));
    }
  }
  indices.accessor = {{"componentType", shorts ? kUnsignedShort : kUnsignedInt},
                      {"count", corners.triangles.size()},
                      {"type", "SCALAR"}};
  return indices;
}

std::string Padded(std::string bytes, char with) {
  constexpr std::size_t kAlignment = 4;
  bytes.resize((bytes.size() + kAlignment - 1) / kAlignment * kAlignment, with);
  return bytes;
}

// The scene and the binary chunk, surface by surface.
class GlbScene {
 public:
  explicit GlbScene(double metres) {
    const double half = std::numbers::sqrt2 / 2;
    document_["asset"] = Json::object({{"version", "2.0"}, {"generator", "batten"}});
    document_["scene"] = 0;
    document_["scenes"] = Json::array({Json::object({{"nodes", Json::array({0})}})});
    document_["nodes"] =
        Json::array({Json::object({{"name", "batten"},
                                   {"rotation", Json::array({-half, 0, 0, half})},
                                   {"scale", Json::array({metres, metres, metres})},
                                   {"children", Json::array()}})});
    for (const char* list : {"meshes", "materials", "accessors", "bufferViews"})
      document_[list] = Json::array();
  }

  void Add(const GlbSurface& given) {
    const TriangleMesh& mesh = given.surface.mesh;
    if (mesh.triangles.cols() == 0) return;
    const Corners corners = CornersOf(mesh);
    const Eigen::Vector3d middle =
        mesh.vertices.rowwise().minCoeff() / 2 + mesh.vertices.rowwise().maxCoeff() / 2;
    Json attributes = Json::object();
    attributes["POSITION"] = Put(Positions(mesh, corners, middle));
    attributes["NORMAL"] = Put(Normals(corners));
    attributes["TEXCOORD_0"] = Put(TextureCoordinates(given.surface, corners));
    const bool coloured = given.colours.cols() > 0;
    if (coloured) attributes["COLOR_0"] = Put(Colours(given.colours, corners));
    const std::size_t indices = Put(Indices(corners));
    const std::size_t number = document_["meshes"].size();
    const Json primitive = Json::object({{"attributes", std::move(attributes)},
                                         {"indices", indices},
                                         {"material", MaterialOf(coloured)}});
    document_["meshes"].push_back(
        Json::object({{"name", given.name}, {"primitives", Json::array({primitive})}}));
    document_["nodes"][0]["children"].push_back(number + 1);
    document_["nodes"].push_back(
        Json::object({{"name", given.name}, {"mesh", number}, {"translation", NumbersOf(middle)}}));
  }

  void Write(AtomicFile& file) {
    document_["buffers"] = Json::array({Json::object({{"byteLength", size_}})});
    const std::string text =
        Padded(document_.dump(-1, ' ', false, Json::error_handler_t::replace), ' ');
    constexpr std::size_t kHeader = 12, kChunkHeader = 8;
    const std::size_t whole = kHeader + 2 * kChunkHeader + text.size() + size_;
    if (whole > std::numeric_limits<std::uint32_t>::max()) {
      throw UsageError(
          "more than the 4 GB a .glb can hold: raise --chord-tolerance, or write .ply");
    }
    std::string head;
    for (const std::uint32_t word : {kGlbMagic,
                                     kGlbVersion,
                                     static_cast<std::uint32_t>(whole),
                                     static_cast<std::uint32_t>(text.size()),
                                     kJsonChunk}) {
      AppendLittleEndian(head, word);
    }
    head += text;
    AppendLittleEndian(head, static_cast<std::uint32_t>(size_));
    AppendLittleEndian(head, kBinaryChunk);
    file.Write(head);
    for (const std::string& bytes : chunks_) file.Write(bytes);
  }

 private:
  // Returns the index of the accessor.
  std::size_t Put(Stretch stretch) {
    document_["bufferViews"].push_back(Json::object({{"buffer", 0},
                                                     {"byteOffset", size_},
                                                     {"byteLength", stretch.bytes.size()},
                                                     {"target", stretch.target}}));
    Json accessor = std::move(stretch.accessor);
    accessor["bufferView"] = document_["bufferViews"].size() - 1;
    document_["accessors"].push_back(std::move(accessor));
    chunks_.push_back(Padded(std::move(stretch.bytes), '\0'));
    size_ += chunks_.back().size();
    return document_["accessors"].size() - 1;
  }

  // A light grey, or white that lets vertex colours through; made when first asked for.
  std::size_t MaterialOf(bool coloured) {
    auto& known = coloured ? coloured_ : plain_;
    if (known) return *known;
    constexpr double kGrey = 0.7;
    const double base = coloured ? 1.0 : kGrey;
    known = document_["materials"].size();
    const Json reflection = Json::object({{"baseColorFactor", Json::array({base, base, base, 1})},
                                          {"metallicFactor", 0},
                                          {"roughnessFactor", 0.6}});
    document_["materials"].push_back(Json::object({{"name", coloured ? "deviation" : "surface"},
                                                   {"pbrMetallicRoughness", reflection},
                                                   {"doubleSided", true}}));
    return *known;
  }

  Json document_;
  std::vector<std::string> chunks_;
  std::size_t size_ = 0;
  std::optional<std::size_t> plain_, coloured_;
};

}  // namespace

void WriteGlb(const std::vector<GlbSurface>& surfaces, double metres, AtomicFile& file) {
  GlbScene scene(metres);
  for (const GlbSurface& surface : surfaces) scene.Add(surface);
  scene.Write(file);
}

}  // namespace batten::internal
