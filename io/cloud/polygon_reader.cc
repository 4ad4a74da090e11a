// SPDX-License-Identifier: MIT
#include "batten/io/polygon_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "batten/io/atomic_file.h"
#include "batten/io/read_error.h"
#include "geometry/mesh/point_numbers.h"
#include "io/base/whole_file.h"
#include "io/cloud/glb_reader.h"
#include "io/cloud/polygon_text.h"

namespace batten {
namespace internal {
namespace {

constexpr double kFarthest = 1e18;  // as for clouds: squares and cubes stay finite

std::string ExtensionOf(const std::string& path) {
  std::string word = std::filesystem::path(path).extension().string();
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) {
    return static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c);
  });
  return word;
}

// A text word by word, line by line.
class Words {
 public:
  Words(std::string_view text, const std::string& path) : rest_(text), path_(path) {}

  [[noreturn]] void Refuse(const std::string& reason) const {
    throw ReadError::AtLine(path_, number_, reason);
  }

  // Goes to the next line; false at the end.
  bool NextLine() {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find_first_of("\r\n");
    line_ = rest_.substr(0, end);
    std::size_t skip = line_.size();
    if (skip < rest_.size()) {
      skip += rest_[skip] == '\r' && skip + 1 < rest_.size() && rest_[skip + 1] == '\n' ? 2 : 1;
    }
    rest_.remove_prefix(skip);
    line_ = line_.substr(0, line_.find('#'));
    ++number_;
    return true;
  }

  // The next word on the line; empty at its end.
  std::string_view Word() {
    const std::size_t begin = line_.find_first_not_of(" \t");
    if (begin == line_.npos) return line_ = {};
    line_.remove_prefix(begin);
    const std::size_t length = std::min(line_.find_first_of(" \t"), line_.size());
    const std::string_view word = line_.substr(0, length);
    line_.remove_prefix(length);
    return word;
  }

  // The next word of this line or those that follow; empty at the end of the file.
  std::string_view WordAnywhere() {
    for (;;) {
      const std::string_view word = Word();
      if (!word.empty() || !NextLine()) return word;
    }
  }

  double ToNumber(std::string_view word) const {
    double value = 0;
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() ||
        !(std::abs(value) <= kFarthest)) {
      Refuse("expected a coordinate, found '" + std::string(word.substr(0, 40)) + "'");
    }
    return value;
  }

  std::int64_t ToInteger(std::string_view word) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) {
      Refuse("expected a whole number, found '" + std::string(word.substr(0, 40)) + "'");
    }
    return value;
  }

  // What follows the present line, for bodies in binary.
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_, line_;
  const std::string& path_;
  std::int64_t number_ = 0;
};

// Coordinates one after the other as columns.
Eigen::Matrix3Xd Columns(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::Matrix3Xd>(numbers.data(), 3, Eigen::Index(numbers.size() / 3));
}

PolygonMesh ReadObjPolygons(std::string_view text, const std::string& path) {
  Words words(text, path);
  std::vector<double> numbers;
  PolygonMesh mesh;
  while (words.NextLine()) {
    const std::string_view kind = words.Word();
    if (kind == "v") {
      for (int k = 0; k < 3; ++k) numbers.push_back(words.ToNumber(words.Word()));
    } else if (kind == "f") {
      std::vector<int> face;
      const auto count = static_cast<std::int64_t>(numbers.size() / 3);
      for (std::string_view word = words.Word(); !word.empty(); word = words.Word()) {
        const std::int64_t named = words.ToInteger(word.substr(0, word.find('/')));
        // Negative numbers count back from the last vertex so far.
        const std::int64_t index = named < 0 ? count + named : named - 1;
        if (index < 0 || index > std::int64_t{1} << 30) {
          words.Refuse(fmt::format("a face names vertex {}, which is not there", named));
        }
        face.push_back(static_cast<int>(index));
      }
      if (face.size() < 3) words.Refuse("a face has fewer than three vertices");
      mesh.faces.push_back(std::move(face));
    }
  }
  mesh.vertices = Columns(numbers);
  return mesh;
}

PolygonMesh ReadOffPolygons(std::string_view text, const std::string& path) {
  Words words(text, path);
  std::string_view head = words.WordAnywhere();
  std::int64_t vertices = 0, faces = 0;
  if (head.ends_with("OFF")) head = words.WordAnywhere();
  vertices = words.ToInteger(head);
  faces = words.ToInteger(words.WordAnywhere());
  words.NextLine();
  std::vector<double> numbers;
  PolygonMesh mesh;
  const auto next = [&](const char* what) {
    std::string_view word;
    do {
      word = words.Word();
    } while (word.empty() && words.NextLine());
    if (word.empty()) words.Refuse(std::string("the file ends before its last ") + what);
    return word;
  };
  for (std::int64_t k = 0; k < vertices; ++k) {
    numbers.push_back(words.ToNumber(next("vertex")));
    for (int c = 1; c < 3; ++c) numbers.push_back(words.ToNumber(words.Word()));
    words.NextLine();
  }
  for (std::int64_t k = 0; k < faces; ++k) {
    const std::int64_t corners = words.ToInteger(next("face"));
    if (corners < 3) words.Refuse("a face has fewer than three vertices");
    std::vector<int> face;
    for (std::int64_t c = 0; c < corners; ++c) {
      const std::int64_t index = words.ToInteger(words.Word());
      if (index < 0 || index >= vertices) {
        words.Refuse(fmt::format("a face names vertex {} of {}", index, vertices));
      }
      face.push_back(static_cast<int>(index));
    }
    words.NextLine();
    mesh.faces.push_back(std::move(face));
  }
  mesh.vertices = Columns(numbers);
  return mesh;
}

// The corners of triangles as vertices, equal ones once.
class CornerJoiner {
 public:
  void Add(const std::array<double, 9>& corners) {
    std::vector<int> face;
    face.reserve(3);
    for (std::size_t k = 0; k < 3; ++k) face.push_back(points_.NumberOf(&corners[3 * k]));
    // Slivers whose corners fell together are no faces.
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) return;
    faces_.push_back(std::move(face));
  }
  PolygonMesh Mesh() && { return {Columns(points_.coordinates()), std::move(faces_)}; }

 private:
  PointNumbers points_;
  std::vector<std::vector<int>> faces_;
};

PolygonMesh ReadStlPolygons(std::string_view text, const std::string& path) {
  constexpr std::size_t kHead = 84, kRecord = 50;
  CornerJoiner joiner;
  std::uint32_t count = 0;
  if (text.size() >= kHead) std::memcpy(&count, text.data() + 80, sizeof count);
  if (text.size() >= kHead && text.size() >= kHead + kRecord * std::size_t{count} &&
      (!text.starts_with("solid") || text.size() == kHead + kRecord * std::size_t{count})) {
    for (std::size_t k = 0; k < count; ++k) {
      std::array<float, 9> single;
      std::memcpy(single.data(), text.data() + kHead + kRecord * k + 12, sizeof single);
      std::array<double, 9> corners;
      std::copy(single.begin(), single.end(), corners.begin());
      for (const double value : corners) {
        if (!(std::abs(value) <= kFarthest)) {
          throw ReadError::AtByte(
              path, std::int64_t(kHead + kRecord * k), "a corner is not finite");
        }
      }
      joiner.Add(corners);
    }
    return std::move(joiner).Mesh();
  }
  Words words(text, path);
  std::array<double, 9> corners;
  int found = 0;
  while (words.NextLine()) {
    const std::string_view word = words.Word();
    if (word != "vertex" && word != "VERTEX" && word != "Vertex") continue;
    for (int c = 0; c < 3; ++c) corners[std::size_t(3 * found + c)] = words.ToNumber(words.Word());
    if (++found == 3) {
      joiner.Add(corners);
      found = 0;
    }
  }
  return std::move(joiner).Mesh();
}

// Bytes of a scalar type of PLY; 0: unknown.
std::size_t BytesOf(std::string_view type) {
  if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
  if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
  if (type == "int" || type == "uint" || type == "int32" || type == "uint32" || type == "float" ||
      type == "float32") {
    return 4;
  }
  return type == "double" || type == "float64" ? 8 : 0;
}

struct PlyField {
  std::string name, type, count;  // the type of the count of a list; empty: no list
};
struct PlyPart {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyField> fields;
};

class PlyPolygons {
 public:
  PlyPolygons(std::string_view text, const std::string& path) : words_(text, path), path_(path) {}

  PolygonMesh Read() {
    ReadHeader();
    body_ = words_.rest();
    for (const PlyPart& part : parts_) {
      const auto is = [&](const char* name) {
        return std::find_if(part.fields.begin(),
                            part.fields.end(),
                            [&](const PlyField& field) { return field.name == name; }) -
               part.fields.begin();
      };
      const std::array axes = {is("x"), is("y"), is("z")};
      const auto corners = std::min(is("vertex_indices"), is("vertex_index"));
      if (part.name == "vertex" &&
          std::max({axes[0], axes[1], axes[2]}) == std::ssize(part.fields)) {
        words_.Refuse("a vertex has no x, y or z");
      }
      if (part.fields.empty()) continue;  // however many there are said to be
      for (std::int64_t k = 0; k < part.count; ++k) {
        std::array<double, 3> place{};
        for (std::ptrdiff_t f = 0; f < std::ptrdiff_t(part.fields.size()); ++f) {
          const PlyField& field = part.fields[std::size_t(f)];
          if (field.count.empty()) {
            const double value = Scalar(field.type);
            for (int c = 0; c < 3; ++c) {
              if (axes[std::size_t(c)] == f) place[std::size_t(c)] = value;
            }
            continue;
          }
          const double count = Scalar(field.count);
          std::vector<int> face;
          for (double c = 0; c < count; ++c) {
            const double value = Scalar(field.type);
            if (part.name == "face" && f == corners) {
              if (!(value >= 0 && value < 1e9)) Refuse("a face names no vertex");
              face.push_back(static_cast<int>(value));
            }
          }
          if (part.name == "face" && f == corners) {
            if (face.size() < 3) Refuse("a face has fewer than three vertices");
            mesh_.faces.push_back(std::move(face));
          }
        }
        if (part.name != "vertex") continue;
        for (const double value : place) {
          if (!(std::abs(value) <= kFarthest)) Refuse("a coordinate is not finite");
          numbers_.push_back(value);
        }
      }
    }
    mesh_.vertices = Columns(numbers_);
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void Refuse(const std::string& reason) const {
    if (ascii_) words_.Refuse(reason);
    throw ReadError::AtByte(path_, std::int64_t(at_), reason);
  }

  void ReadHeader() {
    if (!words_.NextLine() || words_.Word() != "ply") words_.Refuse("a PLY file begins with 'ply'");
    for (;;) {
      if (!words_.NextLine()) words_.Refuse("the file ends in its header");
      const std::string_view kind = words_.Word();
      if (kind == "end_header") return;
      if (kind == "format") {
        const std::string_view format = words_.Word();
        ascii_ = format == "ascii";
        swapped_ = format == "binary_big_endian";
      } else if (kind == "element") {
        const std::string name(words_.Word());
        parts_.push_back({name, words_.ToInteger(words_.Word()), {}});
      } else if (kind == "property" && !parts_.empty()) {
        PlyField field;
        field.type = words_.Word();
        if (field.type == "list") {
          field.count = words_.Word();
          field.type = words_.Word();
        }
        field.name = words_.Word();
        if (BytesOf(field.type) == 0 || (!field.count.empty() && BytesOf(field.count) == 0)) {
          words_.Refuse("unknown type of a property");
        }
        parts_.back().fields.push_back(std::move(field));
      }
    }
  }

  double Scalar(std::string_view type) {
    if (ascii_) {
      const std::string_view word = words_.WordAnywhere();
      if (word.empty()) words_.Refuse("the file ends before its last element");
      return words_.ToNumber(word);
    }
    const std::size_t bytes = BytesOf(type);
    if (body_.size() - at_ < bytes) Refuse("the file ends before its last element");
    std::array<char, 8> raw{};
    std::memcpy(raw.data(), body_.data() + at_, bytes);
    at_ += bytes;
    if (swapped_) std::reverse(raw.begin(), raw.begin() + std::ptrdiff_t(bytes));
    if (type == "double" || type == "float64") return std::bit_cast<double>(raw);
    const auto as = [&]<typename T>(T value) {
      std::memcpy(&value, raw.data(), sizeof value);
      return static_cast<double>(value);
    };
    if (type == "float" || type == "float32") return as(0.0F);
    const bool has_sign = !type.starts_with('u');
    if (bytes == 1) return has_sign ? as(std::int8_t{}) : as(std::uint8_t{});
    if (bytes == 2) return has_sign ? as(std::int16_t{}) : as(std::uint16_t{});
    return has_sign ? as(std::int32_t{}) : as(std::uint32_t{});
  }

  Words words_;
  const std::string& path_;
  bool ascii_ = true, swapped_ = false;
  std::vector<PlyPart> parts_;
  std::string_view body_;
  std::size_t at_ = 0;
  std::vector<double> numbers_;
  PolygonMesh mesh_;
};

}  // namespace

PolygonMesh PolygonsOfText(std::string_view bytes,
                           const std::string& extension,
                           const std::string& path) {
  PolygonMesh mesh = extension == ".obj"   ? ReadObjPolygons(bytes, path)
                     : extension == ".glb" ? PolygonsOfGlb(bytes, path)
                     : extension == ".off" ? ReadOffPolygons(bytes, path)
                     : extension == ".stl" ? ReadStlPolygons(bytes, path)
                                           : PlyPolygons(bytes, path).Read();
  for (std::size_t k = 0; k < mesh.faces.size(); ++k) {
    for (const int vertex : mesh.faces[k]) {
      if (vertex >= mesh.vertices.cols()) {
        throw ReadError(
            path,
            fmt::format("face {} names vertex {} of {}", k + 1, vertex + 1, mesh.vertices.cols()));
      }
    }
  }
  return mesh;
}

namespace {

bool HasFaceExtension(const std::string& path) {
  const std::string extension = ExtensionOf(path);
  return extension == ".obj" || extension == ".off" || extension == ".ply" || extension == ".stl" ||
         extension == ".glb";
}

bool HeaderSaysFaces(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return true;
  std::ifstream file(path, std::ios::binary);
  std::string line;
  constexpr int kLongestHeader = 1000;  // lines
  for (int k = 0; k < kLongestHeader && std::getline(file, line); ++k) {
    if (line.rfind("end_header", 0) == 0) return false;
    std::istringstream words(line);
    std::string element, name;
    long long count = 0;
    if (words >> element >> name >> count && element == "element" && name == "face")
      return count > 0;
  }
  return true;
}

}  // namespace
}  // namespace internal

using namespace internal;

bool MayHoldFaces(const std::string& path) {
  return HasFaceExtension(path) && (ExtensionOf(path) != ".ply" || HeaderSaysFaces(path));
}

PolygonMesh ReadPolygons(const std::string& path) {
  if (!HasFaceExtension(path))
    throw UsageError(path + ": faces are read from .obj .off .ply .stl .glb");
  return PolygonsOfText(ReadWholeFile(path), ExtensionOf(path), path);
}

QuadMesh ReadQuadMesh(const std::string& path) {
  const PolygonMesh read = ReadPolygons(path);
  if (read.faces.empty())
    throw ReadError(path, "holds no faces: a layout is a mesh of quadrilaterals");
  QuadMesh mesh;
  mesh.vertices = read.vertices;
  mesh.faces.resize(4, Eigen::Index(read.faces.size()));
  for (std::size_t k = 0; k < read.faces.size(); ++k) {
    if (read.faces[k].size() != 4) {
      throw ReadError(path,
                      fmt::format("face {} has {} vertices: all faces of a layout have four",
                                  k + 1,
                                  read.faces[k].size()));
    }
    std::copy(read.faces[k].begin(), read.faces[k].end(), mesh.faces.col(Eigen::Index(k)).begin());
  }
  return mesh;
}

void WriteQuadMesh(const QuadMesh& mesh, const std::string& path) {
  AtomicFile file(path);
  file.Write("# written by batten\n");
  for (const auto vertex : mesh.vertices.colwise()) {
    file.Write(fmt::format("v {} {} {}\n", vertex[0], vertex[1], vertex[2]));
  }
  for (const auto face : mesh.faces.colwise()) {
    file.Write(fmt::format("f {} {} {} {}\n", face[0] + 1, face[1] + 1, face[2] + 1, face[3] + 1));
  }
  file.Commit();
}

}  // namespace batten
