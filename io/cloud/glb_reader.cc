// SPDX-License-Identifier: MIT
#include "io/cloud/glb_reader.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "batten/io/read_error.h"
#include "geometry/mesh/point_numbers.h"
#include "io/base/little_endian.h"
#include "io/cloud/glb_words.h"

namespace batten::internal {
namespace {

using GlbJson = nlohmann::json;  // that of the writer keeps orders

constexpr double kFarthestPlace = 1e18;  // as for clouds: squares and cubes stay finite

// Numbers of an accessor: `count` of `width` components each.
struct Accessor {
  std::size_t at = 0, count = 0, stride = 0, component = 0;
};

std::size_t BytesOf(std::size_t component) {
  switch (component) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

class GlbReader {
 public:
  GlbReader(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  PolygonMesh Read() {
    ReadChunks();
    RefuseExtensions();
    for (const std::size_t root : Roots()) AddNode(root, Eigen::Affine3d::Identity(), 0);
    const std::vector<double>& coordinates = places_.coordinates();
    mesh_.vertices = Eigen::Map<const Eigen::Matrix3Xd>(coordinates.data(), 3, places_.size());
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void RefuseAt(std::size_t byte, const std::string& reason) const {
    throw ReadError::AtByte(path_, static_cast<std::int64_t>(byte), reason);
  }
  [[noreturn]] void Refuse(const std::string& reason) const { throw ReadError(path_, reason); }

  // A chunk of this kind at the place, which moves behind it.
  std::string_view Chunk(std::size_t& at, std::uint32_t kind, const char* name) const {
    constexpr std::size_t kHead = 8;
    if (bytes_.size() < at + kHead) RefuseAt(bytes_.size(), "the file ends before its chunks");
    const std::size_t size = LoadLittleEndian<std::uint32_t>(bytes_, at);
    if (LoadLittleEndian<std::uint32_t>(bytes_, at + 4) != kind)
      RefuseAt(at + 4, std::string("a chunk of ") + name + " is expected");
    at += kHead;
    if (bytes_.size() - at < size) {
      RefuseAt(
          at,
          fmt::format(
              "a chunk of {} of {} bytes is promised, {} follow", name, size, bytes_.size() - at));
    }
    const std::string_view chunk = bytes_.substr(at, size);
    at += size;
    return chunk;
  }

  void ReadChunks() {
    constexpr std::size_t kHeader = 12;
    if (bytes_.size() < kHeader || LoadLittleEndian<std::uint32_t>(bytes_, 0) != kGlbMagic)
      RefuseAt(0, "is no .glb file: it does not begin with the word glTF");
    const auto version = LoadLittleEndian<std::uint32_t>(bytes_, 4);
    if (version != kGlbVersion)
      RefuseAt(4, fmt::format("is of version {}: only glTF 2 is read", version));
    const std::size_t length = LoadLittleEndian<std::uint32_t>(bytes_, 8);
    if (length < bytes_.size()) bytes_ = bytes_.substr(0, std::max(length, kHeader));
    std::size_t at = kHeader;
    const std::string_view text = Chunk(at, kJsonChunk, "JSON");
    try {
      document_ = GlbJson::parse(text);
    } catch (const GlbJson::exception& error) {
      Refuse(std::string("its JSON can't be read: ") + error.what());
    }
    if (!document_.is_object()) Refuse("its JSON is no object");
    // Chunks of other kinds are to be passed over; that of bytes comes first.
    if (bytes_.size() >= at + 8 && LoadLittleEndian<std::uint32_t>(bytes_, at + 4) == kBinaryChunk)
      binary_ = Chunk(at, kBinaryChunk, "bytes");
  }

  // What is needed to read the shape, and is not understood.
  void RefuseExtensions() const {
    for (const GlbJson& name : ListOf(document_, "extensionsRequired")) {
      if (!name.is_string()) Refuse("extensionsRequired holds what is no name");
      const auto& word = name.get_ref<const std::string&>();
      const bool looks = word.starts_with("KHR_materials_") || word.starts_with("KHR_texture_") ||
                         word.starts_with("EXT_texture_") || word == "KHR_lights_punctual";
      if (!looks) Refuse("needs " + word + ", which is not read: export it without compression");
    }
  }

  // The list of that name; empty where there is none.
  const GlbJson& ListOf(const GlbJson& object, const char* name) const {
    static const GlbJson kNone = GlbJson::array();
    const auto found = object.find(name);
    if (found == object.end()) return kNone;
    if (!found->is_array()) Refuse(std::string(name) + " is no list");
    return *found;
  }

  const GlbJson& ItemOf(const char* list, std::size_t index) const {
    const GlbJson& items = ListOf(document_, list);
    if (index >= items.size() || !items[index].is_object())
      Refuse(fmt::format("{}[{}] is named and not there", list, index));
    return items[index];
  }

  // A member that is a whole number.
  std::optional<std::size_t> WholeOf(const GlbJson& object, const char* name) const {
    const auto found = object.find(name);
    if (found == object.end()) return std::nullopt;
    if (!found->is_number_unsigned()) Refuse(std::string(name) + " is no whole number");
    return found->get<std::size_t>();
  }

  std::size_t IndexOf(const GlbJson& number, const char* name) const {
    if (!number.is_number_unsigned()) Refuse(std::string(name) + " holds no index");
    return number.get<std::size_t>();
  }

  // The nodes of the scene; without scenes those that are no child.
  std::vector<std::size_t> Roots() const {
    std::vector<std::size_t> roots;
    const auto scene = WholeOf(document_, "scene");
    if (scene || !ListOf(document_, "scenes").empty()) {
      for (const GlbJson& node : ListOf(ItemOf("scenes", scene.value_or(0)), "nodes"))
        roots.push_back(IndexOf(node, "nodes"));
      return roots;
    }
    const std::size_t count = ListOf(document_, "nodes").size();
    std::vector<bool> child(count, false);
    for (std::size_t k = 0; k < count; ++k) {
      for (const GlbJson& one : ListOf(ItemOf("nodes", k), "children")) {
        const std::size_t index = IndexOf(one, "children");
        if (index < count) child[index] = true;
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      if (!child[k]) roots.push_back(k);
    }
    return roots;
  }

  // Numbers of a node, of the size they must have.
  std::optional<Eigen::VectorXd> NumbersOf(const GlbJson& node, const char* name, int size) const {
    if (!node.contains(name)) return std::nullopt;
    const GlbJson& list = ListOf(node, name);
    Eigen::VectorXd numbers(size);
    bool sound = static_cast<int>(list.size()) == size;
    for (int k = 0; sound && k < size; ++k) {
      sound = list[static_cast<std::size_t>(k)].is_number();
      if (sound) numbers[k] = list[static_cast<std::size_t>(k)].get<double>();
    }
    if (!sound || !numbers.allFinite())
      Refuse(fmt::format("{} of a node is not {} finite numbers", name, size));
    return numbers;
  }

  Eigen::Affine3d PlaceOf(const GlbJson& node) const {
    Eigen::Affine3d place = Eigen::Affine3d::Identity();
    if (const auto matrix = NumbersOf(node, "matrix", 16)) {
      place.matrix() = Eigen::Map<const Eigen::Matrix4d>(matrix->data());
      return place;
    }
    if (const auto shift = NumbersOf(node, "translation", 3))
      place.translate(Eigen::Vector3d(*shift));
    if (const auto turn = NumbersOf(node, "rotation", 4)) {
      const Eigen::Quaterniond q((*turn)[3], (*turn)[0], (*turn)[1], (*turn)[2]);
      if (!(q.norm() > 0)) Refuse("rotation of a node is zero");
      place.rotate(q.normalized());
    }
    if (const auto scale = NumbersOf(node, "scale", 3)) place.scale(Eigen::Vector3d(*scale));
    return place;
  }

  void AddNode(std::size_t index, const Eigen::Affine3d& above, int depth) {
    constexpr int kDeepest = 200;
    if (seen_.size() < ListOf(document_, "nodes").size())
      seen_.resize(ListOf(document_, "nodes").size(), false);
    const GlbJson& node = ItemOf("nodes", index);
    if (seen_[index] || depth > kDeepest)
      Refuse(fmt::format("nodes[{}] has several parents, or too many above it", index));
    seen_[index] = true;
    const Eigen::Affine3d place = above * PlaceOf(node);
    if (node.contains("extensions") && node["extensions"].contains("EXT_mesh_gpu_instancing"))
      Refuse(fmt::format("nodes[{}] needs EXT_mesh_gpu_instancing, which is not read", index));
    if (const auto mesh = WholeOf(node, "mesh")) {
      // Joints place a skinned mesh, not its node: it is as it was bound.
      const Eigen::Affine3d own = node.contains("skin") ? Eigen::Affine3d::Identity() : place;
      for (const GlbJson& primitive : ListOf(ItemOf("meshes", *mesh), "primitives"))
        AddPrimitive(primitive, own);
    }
    for (const GlbJson& child : ListOf(node, "children"))
      AddNode(IndexOf(child, "children"), place, depth + 1);
  }

  Accessor AccessorOf(std::size_t index, const char* type, std::size_t width) const {
    const GlbJson& accessor = ItemOf("accessors", index);
    const auto name = [&] { return fmt::format("accessors[{}]", index); };
    if (accessor.contains("sparse"))
      Refuse(name() + " is sparse, which is not read: export it in full");
    const auto own_type = accessor.find("type");
    if (own_type == accessor.end() || !own_type->is_string() ||
        own_type->get_ref<const std::string&>() != type)
      Refuse(name() + " is not of type " + type);
    Accessor found;
    found.component = WholeOf(accessor, "componentType").value_or(0);
    found.count = WholeOf(accessor, "count").value_or(0);
    const std::size_t bytes = BytesOf(found.component) * width;
    if (bytes == 0) Refuse(name() + " has no known component type");
    if (found.count == 0) return found;
    const auto view_index = WholeOf(accessor, "bufferView");
    if (!view_index) Refuse(name() + " has no bytes");
    const GlbJson& view = ItemOf("bufferViews", *view_index);
    const std::size_t buffer = WholeOf(view, "buffer").value_or(0);
    if (buffer != 0 || ItemOf("buffers", buffer).contains("uri"))
      Refuse(name() + " is in another file: export all of it into the .glb");
    const std::size_t begin = WholeOf(view, "byteOffset").value_or(0),
                      size = WholeOf(view, "byteLength").value_or(0),
                      offset = WholeOf(accessor, "byteOffset").value_or(0);
    found.stride = WholeOf(view, "byteStride").value_or(bytes);
    // By subtraction: sums of what a file says may overflow.
    const bool inside = begin <= binary_.size() && size <= binary_.size() - begin &&
                        found.stride >= bytes && offset <= size && bytes <= size - offset &&
                        found.count - 1 <= (size - offset - bytes) / found.stride;
    if (!inside) {
      Refuse(fmt::format("{} promises {} items of {} bytes, beyond the {} bytes of the file's own",
                         name(),
                         found.count,
                         bytes,
                         binary_.size()));
    }
    found.at = begin + offset;
    return found;
  }

  void AddPrimitive(const GlbJson& primitive, const Eigen::Affine3d& place) {
    if (!primitive.is_object()) Refuse("a primitive of a mesh is no object");
    const std::size_t mode = WholeOf(primitive, "mode").value_or(kTriangles);
    if (mode != kPoints && mode != kTriangles && mode != kStrip && mode != kFan) return;
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object())
      Refuse("a primitive of a mesh has no attributes");
    const auto position = WholeOf(*attributes, "POSITION");
    if (!position) return;  // it is not drawn
    const Accessor positions = AccessorOf(*position, "VEC3", 3);
    if (positions.component != kFloat)
      Refuse(fmt::format("accessors[{}]: positions are not of floats", *position));
    std::vector<std::size_t> corners;
    if (const auto indices = WholeOf(primitive, "indices")) {
      corners = IndicesOf(*indices, positions.count);
    } else {
      Take(positions.count);
      for (std::size_t k = 0; k < positions.count; ++k) corners.push_back(k);
    }
    // Those that are named alone: several primitives may share what an accessor holds.
    std::vector<int> numbers(positions.count, -1);
    for (const std::size_t corner : corners) {
      if (numbers[corner] < 0) numbers[corner] = NumberOf(positions, corner, *position, place);
    }
    if (mode == kPoints) return;
    const bool mirrored = place.linear().determinant() < 0;
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
      if (mirrored) std::swap(b, c);
      const int x = numbers[corners[a]], y = numbers[corners[b]], z = numbers[corners[c]];
      if (x != y && y != z && z != x) mesh_.faces.push_back({x, y, z});
    };
    for (std::size_t k = 0; k + 2 < corners.size(); k += mode == kTriangles ? 3 : 1) {
      if (mode == kFan) {
        add(0, k + 1, k + 2);
      } else {
        const bool other_way = mode == kStrip && k % 2 == 1;
        add(k, k + (other_way ? 2 : 1), k + (other_way ? 1 : 2));
      }
    }
  }

  // Counts what is placed: a short file can place a mesh very often.
  void Take(std::size_t count) {
    constexpr std::size_t kAlways = 10000000, kPerByte = 4;  // budget: some 300 MB
    placed_ += count;
    const std::size_t most = std::max(kAlways, kPerByte * bytes_.size());
    if (placed_ > most) Refuse(fmt::format("places more than {} corners", most));
  }

  // The number of a vertex where its node puts it.
  int NumberOf(const Accessor& positions,
               std::size_t k,
               std::size_t index,
               const Eigen::Affine3d& place) {
    Eigen::Vector3d p;
    for (std::size_t d = 0; d < 3; ++d) {
      p[static_cast<Eigen::Index>(d)] =
          LoadLittleEndian<float>(binary_, positions.at + k * positions.stride + d * sizeof(float));
    }
    const Eigen::Vector3d at = place * p;
    if (!at.allFinite() || !(at.cwiseAbs().maxCoeff() < kFarthestPlace))
      Refuse(fmt::format("accessors[{}]: vertex {} is not finite, or beyond 1e18", index, k));
    const Eigen::Vector3d upright(at.x(), -at.z(), at.y());
    return places_.NumberOf(upright.data());
  }

  std::vector<std::size_t> IndicesOf(std::size_t index, std::size_t vertices) {
    const Accessor indices = AccessorOf(index, "SCALAR", 1);
    Take(indices.count);
    std::vector<std::size_t> corners;
    corners.reserve(indices.count);
    for (std::size_t k = 0; k < indices.count; ++k) {
      const std::size_t at = indices.at + k * indices.stride;
      std::size_t corner = 0;
      switch (indices.component) {
        case kUnsignedByte:
          corner = LoadLittleEndian<std::uint8_t>(binary_, at);
          break;
        case kUnsignedShort:
          corner = LoadLittleEndian<std::uint16_t>(binary_, at);
          break;
        case kUnsignedInt:
          corner = LoadLittleEndian<std::uint32_t>(binary_, at);
          break;
        default:
          Refuse(fmt::format("accessors[{}]: indices are not of whole numbers", index));
      }
      if (corner >= vertices)
        Refuse(fmt::format(
            "accessors[{}]: index {} names vertex {} of {}", index, k, corner, vertices));
      corners.push_back(corner);
    }
    return corners;
  }

  std::string_view bytes_, binary_;
  const std::string& path_;
  GlbJson document_;
  std::vector<bool> seen_;
  std::size_t placed_ = 0;
  PointNumbers places_;
  PolygonMesh mesh_;
};

}  // namespace

PolygonMesh PolygonsOfGlb(std::string_view bytes, const std::string& path) {
  return GlbReader(bytes, path).Read();
}

}  // namespace batten::internal
