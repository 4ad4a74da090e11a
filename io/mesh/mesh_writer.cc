// SPDX-License-Identifier: MIT
#include "batten/io/mesh_writer.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "batten/io/atomic_file.h"
#include "batten/io/deviation_colours.h"
#include "batten/io/read_error.h"
#include "io/base/little_endian.h"
#include "io/mesh/glb_writer.h"
#include "io/mesh/vertex_numbers.h"

namespace batten {
using namespace internal;
namespace {

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return text;
}

// What is written: meshes with their names and, where there are deviations, their colours.
struct Scene {
  const std::vector<SurfaceMesh>& meshes;
  std::vector<std::string> names;
  std::vector<RgbColumns> colours;  // of each mesh; no columns: none
  // Of every vertex of each mesh: its number in the file.
  std::vector<std::vector<std::int64_t>> numbers;
  bool coloured = false;  // any of them
  Eigen::Index vertices = 0, triangles = 0;

  // Whether the vertex is the first with its number when the vertices are gone through in order.
  bool First(std::size_t mesh, Eigen::Index vertex, std::int64_t written) const {
    return numbers[mesh][static_cast<std::size_t>(vertex)] == written;
  }
};

double RangeOf(const std::vector<SurfaceMesh>& meshes) {
  Eigen::Index count = 0;
  for (const SurfaceMesh& one : meshes) count += one.deviations.size();
  Eigen::VectorXd all(count);
  count = 0;
  for (const SurfaceMesh& one : meshes) {
    all.segment(count, one.deviations.size()) = one.deviations;
    count += one.deviations.size();
  }
  return DeviationRange(all);
}

Scene SceneOf(const std::vector<SurfaceMesh>& meshes, double range) {
  Scene scene{meshes, {}, {}, VertexNumbers(meshes)};
  const double shown = range > 0 ? range : RangeOf(meshes);
  for (const SurfaceMesh& one : meshes) {
    if (one.deviations.size() != 0 && one.deviations.size() != one.mesh.vertices.cols()) {
      throw std::invalid_argument("WriteMeshes: deviations: one for every vertex is needed");
    }
    const std::size_t number = scene.names.size() + 1;
    scene.names.push_back(one.name.empty() ? fmt::format("surface-{}", number) : one.name);
    scene.colours.push_back(DeviationColours(one.deviations, shown));
    scene.coloured = scene.coloured || one.deviations.size() > 0;
    scene.triangles += one.mesh.triangles.cols();
  }
  for (const std::vector<std::int64_t>& own : scene.numbers) {
    for (const std::int64_t number : own) {
      scene.vertices = std::max<Eigen::Index>(scene.vertices, number + 1);
    }
  }
  return scene;
}

// On one line, and one word: many readers take a name to end at the first space.
std::string ObjName(std::string name) {
  for (char& c : name) {
    if (std::isspace(static_cast<unsigned char>(c)) || std::iscntrl(static_cast<unsigned char>(c)))
      c = '_';
  }
  return name;
}

// Vertices have numbers of their own for their places and for what they are on each side:
// parameters and normals have the same.
void WriteObj(const Scene& scene, AtomicFile& file) {
  file.Write("# written by batten\n");
  Eigen::Index places = 0, sides = 0;
  std::string text;
  const auto put = [&]<typename... T>(fmt::format_string<T...> words, T&&... parts) {
    text.clear();
    fmt::format_to(std::back_inserter(text), words, std::forward<T>(parts)...);
    file.Write(text);
  };
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const TriangleMesh& mesh = scene.meshes[m].mesh;
    const RgbColumns& colours = scene.colours[m];
    put("o {}\n", ObjName(scene.names[m]));
    for (Eigen::Index k = 0; k < mesh.vertices.cols(); ++k) {
      if (!scene.First(m, k, places)) continue;
      ++places;
      const auto p = mesh.vertices.col(k);
      if (colours.cols() == 0) {
        put("v {} {} {}\n", p[0], p[1], p[2]);
        continue;
      }
      constexpr double kWhite = 255;
      put("v {} {} {} {:.4g} {:.4g} {:.4g}\n",
          p[0],
          p[1],
          p[2],
          colours(0, k) / kWhite,
          colours(1, k) / kWhite,
          colours(2, k) / kWhite);
    }
    for (const auto p : mesh.parameters.colwise()) put("vt {} {}\n", p[0], p[1]);
    for (const OtherSide& side : mesh.other_sides)
      put("vt {} {}\n", side.parameter[0], side.parameter[1]);
    for (const auto n : mesh.normals.colwise()) put("vn {} {} {}\n", n[0], n[1], n[2]);
    for (const OtherSide& side : mesh.other_sides)
      put("vn {} {} {}\n", side.normal[0], side.normal[1], side.normal[2]);
    Eigen::Matrix3Xi named = mesh.triangles;
    for (const SideCorner& corner : mesh.side_corners) {
      named(corner.corner, corner.triangle) = static_cast<int>(mesh.vertices.cols()) + corner.side;
    }
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
      const auto place = [&](int corner) {
        return scene.numbers[m][static_cast<std::size_t>(mesh.triangles(corner, t))] + 1;
      };
      const auto side = named.col(t);
      put("f {0}/{1}/{1} {2}/{3}/{3} {4}/{5}/{5}\n",
          place(0),
          sides + side[0] + 1,
          place(1),
          sides + side[1] + 1,
          place(2),
          sides + side[2] + 1);
    }
    sides += mesh.vertices.cols() + static_cast<Eigen::Index>(mesh.other_sides.size());
  }
}

void WriteStl(const Scene& scene, AtomicFile& file) {
  constexpr std::size_t kHeader = 80;
  std::string record = "binary STL written by batten";
  record.resize(kHeader, ' ');
  AppendLittleEndian(record, static_cast<std::uint32_t>(scene.triangles));
  file.Write(record);
  for (const SurfaceMesh& one : scene.meshes) {
    const TriangleMesh& mesh = one.mesh;
    for (const auto triangle : mesh.triangles.colwise()) {
      const Eigen::Vector3d a = mesh.vertices.col(triangle[0]);
      const Eigen::Vector3d b = mesh.vertices.col(triangle[1]);
      const Eigen::Vector3d c = mesh.vertices.col(triangle[2]);
      record.clear();
      AppendAllLittleEndian<float>(record, (b - a).cross(c - a).stableNormalized().eval());
      for (const Eigen::Vector3d& corner : {a, b, c}) AppendAllLittleEndian<float>(record, corner);
      AppendLittleEndian(record, std::uint16_t{0});
      file.Write(record);
    }
  }
}

void WritePly(const Scene& scene, AtomicFile& file) {
  std::string record = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment written by batten\nelement vertex {}\n",
      scene.vertices);
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "u", "v"}) {
    record += fmt::format("property double {}\n", name);
  }
  if (scene.coloured) {
    for (const char* name : {"red", "green", "blue"})
      record += fmt::format("property uchar {}\n", name);
    record += "property double deviation\nproperty uchar measured\n";
  }
  record += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                        scene.triangles);
  file.Write(record);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::int64_t written = 0;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const TriangleMesh& mesh = scene.meshes[m].mesh;
    const Eigen::VectorXd& deviations = scene.meshes[m].deviations;
    for (Eigen::Index k = 0; k < mesh.vertices.cols(); ++k) {
      if (!scene.First(m, k, written)) continue;
      ++written;
      record.clear();
      AppendAllLittleEndian<double>(record, mesh.vertices.col(k));
      AppendAllLittleEndian<double>(record, mesh.normals.col(k));
      AppendAllLittleEndian<double>(record, mesh.parameters.col(k));
      if (scene.coloured) {
        const double deviation = deviations.size() > 0 ? deviations[k] : kNone;
        const bool measured = !std::isnan(deviation);
        const Rgb colour =
            deviations.size() > 0 ? Rgb(scene.colours[m].col(k)) : DeviationColour(kNone, 1);
        AppendAllLittleEndian<std::uint8_t>(record, colour);
        AppendLittleEndian(record, measured ? deviation : 0.0);
        AppendLittleEndian(record, static_cast<std::uint8_t>(measured));
      }
      file.Write(record);
    }
  }
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    for (const auto triangle : scene.meshes[m].mesh.triangles.colwise()) {
      record.clear();
      AppendLittleEndian(record, std::uint8_t{3});
      for (const int vertex : triangle) {
        const std::int64_t number = scene.numbers[m][static_cast<std::size_t>(vertex)];
        AppendLittleEndian(record, static_cast<std::int32_t>(number));
      }
      file.Write(record);
    }
  }
}

}  // namespace

MeshFormat MeshFormatOf(const std::string& path, const std::string& format) {
  std::string word = Lower(format);
  if (word.empty()) {
    if (path == "-") throw UsageError("-: standard output needs --format: obj, stl, ply or glb");
    word = Lower(std::filesystem::path(path).extension().string());
    if (!word.empty()) word.erase(0, 1);
  }
  if (word == "obj") return MeshFormat::kObj;
  if (word == "stl") return MeshFormat::kStl;
  if (word == "ply") return MeshFormat::kPly;
  if (word == "glb") return MeshFormat::kGlb;
  throw UsageError((format.empty() ? path : "--format " + format) +
                   ": meshes are written as .stl .obj .ply .glb");
}

void WriteMeshes(const std::vector<SurfaceMesh>& meshes,
                 const std::string& path,
                 const MeshWriteOptions& options) {
  const MeshFormat format = MeshFormatOf(path, options.format);
  if (!(options.metres > 0) || !std::isfinite(options.metres)) {
    throw std::invalid_argument("WriteMeshes: options.metres: must be positive");
  }
  const Scene scene = SceneOf(meshes, options.range);
  if (scene.triangles == 0) throw std::invalid_argument("WriteMeshes: meshes: no triangles");
  if (scene.coloured && format == MeshFormat::kStl) {
    throw UsageError(path + ": STL holds no colours: deviations need .ply, .glb or .obj");
  }
  AtomicFile file(path);
  switch (format) {
    case MeshFormat::kObj:
      WriteObj(scene, file);
      break;
    case MeshFormat::kStl:
      WriteStl(scene, file);
      break;
    case MeshFormat::kPly:
      WritePly(scene, file);
      break;
    case MeshFormat::kGlb: {
      std::vector<GlbSurface> surfaces;
      for (std::size_t m = 0; m < meshes.size(); ++m) {
        surfaces.push_back({meshes[m], scene.names[m], scene.colours[m]});
      }
      WriteGlb(surfaces, options.metres, file);
      break;
    }
  }
  file.Commit();
}

void WriteMesh(const TriangleMesh& mesh, const std::string& path, const std::string& format) {
  WriteMeshes({{.mesh = mesh}}, path, {.format = format});
}

}  // namespace batten
