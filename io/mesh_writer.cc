// SPDX-License-Identifier: MIT
#include "batten/io/mesh_writer.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>

#include "batten/io/atomic_file.h"
#include "batten/io/read_error.h"

namespace batten {
namespace {

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return text;
}

// In little-endian order.
template <class T>
void Append(std::string& buffer, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes, bytes + sizeof value);
  buffer.append(bytes, sizeof value);
}

template <class Scalar, class Vector>
void AppendAll(std::string& buffer, const Vector& numbers) {
  for (const double number : numbers) Append(buffer, static_cast<Scalar>(number));
}

void WriteObj(const TriangleMesh& mesh, AtomicFile& file) {
  file.Write("# written by batten\n");
  for (const auto p : mesh.vertices.colwise())
    file.Write(fmt::format("v {} {} {}\n", p[0], p[1], p[2]));
  for (const auto p : mesh.parameters.colwise()) file.Write(fmt::format("vt {} {}\n", p[0], p[1]));
  for (const auto n : mesh.normals.colwise())
    file.Write(fmt::format("vn {} {} {}\n", n[0], n[1], n[2]));
  for (const auto t : mesh.triangles.colwise()) {
    const int a = t[0] + 1, b = t[1] + 1, c = t[2] + 1;
    file.Write(fmt::format("f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", a, b, c));
  }
}

void WriteStl(const TriangleMesh& mesh, AtomicFile& file) {
  constexpr std::size_t kHeader = 80;
  std::string record = "binary STL written by batten";
  record.resize(kHeader, ' ');
  Append(record, static_cast<std::uint32_t>(mesh.triangles.cols()));
  file.Write(record);
  for (const auto triangle : mesh.triangles.colwise()) {
    const Eigen::Vector3d a = mesh.vertices.col(triangle[0]);
    const Eigen::Vector3d b = mesh.vertices.col(triangle[1]);
    const Eigen::Vector3d c = mesh.vertices.col(triangle[2]);
    record.clear();
    AppendAll<float>(record, (b - a).cross(c - a).stableNormalized().eval());
    for (const Eigen::Vector3d& corner : {a, b, c}) AppendAll<float>(record, corner);
    Append(record, std::uint16_t{0});
    file.Write(record);
  }
}

void WritePly(const TriangleMesh& mesh, AtomicFile& file) {
  std::string record = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment written by batten\nelement vertex {}\n",
      mesh.vertices.cols());
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "u", "v"}) {
    record += fmt::format("property double {}\n", name);
  }
  record += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                        mesh.triangles.cols());
  file.Write(record);
  for (Eigen::Index k = 0; k < mesh.vertices.cols(); ++k) {
    record.clear();
    AppendAll<double>(record, mesh.vertices.col(k));
    AppendAll<double>(record, mesh.normals.col(k));
    AppendAll<double>(record, mesh.parameters.col(k));
    file.Write(record);
  }
  for (const auto triangle : mesh.triangles.colwise()) {
    record.clear();
    Append(record, std::uint8_t{3});
    for (const int vertex : triangle) Append(record, static_cast<std::int32_t>(vertex));
    file.Write(record);
  }
}

}  // namespace

MeshFormat MeshFormatOf(const std::string& path, const std::string& format) {
  std::string word = Lower(format);
  if (word.empty()) {
    if (path == "-") throw UsageError("-: standard output needs --format: obj, stl or ply");
    word = Lower(std::filesystem::path(path).extension().string());
    if (!word.empty()) word.erase(0, 1);
  }
  if (word == "obj") return MeshFormat::kObj;
  if (word == "stl") return MeshFormat::kStl;
  if (word == "ply") return MeshFormat::kPly;
  throw UsageError((format.empty() ? path : "--format " + format) +
                   ": meshes are written as .stl .obj .ply");
}

void WriteMesh(const TriangleMesh& mesh, const std::string& path, const std::string& format) {
  const MeshFormat chosen = MeshFormatOf(path, format);
  AtomicFile file(path);
  switch (chosen) {
    case MeshFormat::kObj:
      WriteObj(mesh, file);
      break;
    case MeshFormat::kStl:
      WriteStl(mesh, file);
      break;
    case MeshFormat::kPly:
      WritePly(mesh, file);
      break;
  }
  file.Commit();
}

}  // namespace batten
