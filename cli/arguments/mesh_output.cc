// SPDX-License-Identifier: MIT
#include "cli/arguments/mesh_output.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/bounding_box.h"
#include "batten/geometry/tessellate.h"
#include "batten/io/deviation_colours.h"
#include "batten/io/geometry_file.h"
#include "batten/io/length_unit.h"
#include "batten/io/mesh_writer.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cli/arguments/fit_output.h"
#include "cli/arguments/geometry_flags.h"
#include "cli/arguments/geometry_output.h"
#include "cli/arguments/mesh_deviation.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/streams.h"
#include "cli/terminal/terminal.h"

namespace batten::internal {
namespace {

struct NamedSurfaces {
  std::vector<NurbsSurface> surfaces;
  std::vector<std::string> names;
  std::string unit;
};

// The surfaces of the file; curves have no mesh.
NamedSurfaces Surfaces(const MeshRequest& a) {
  BeginReading({a.geometry}, a.flags.quiet);
  const GeometryContents contents =
      ReadInUnit(a.geometry, a.geometry_format, {.unit = a.unit}, a.flags.quiet);
  NamedSurfaces found;
  found.unit = contents.unit.empty() ? "mm" : contents.unit;
  for (size_t k = 0; k < contents.geometry.size(); ++k) {
    const auto* surface = std::get_if<NurbsSurface>(&contents.geometry[k]);
    if (!surface) continue;
    found.surfaces.push_back(*surface);
    found.names.push_back(contents.names[k]);
  }
  if (found.surfaces.empty()) throw ReadError(a.geometry, "holds no surface, only curves");
  if (found.surfaces.size() < contents.geometry.size() && !a.flags.quiet) {
    PrintWarning(fmt::format("{}: {} curves are left out: they have no mesh",
                             a.geometry,
                             contents.geometry.size() - found.surfaces.size()));
  }
  return found;
}

double DefaultTolerance(const std::vector<NurbsSurface>& surfaces) {
  constexpr double kShare = 1e-3;
  Eigen::AlignedBox3d box;
  for (const NurbsSurface& surface : surfaces) box.extend(BoundingBox(surface));
  return kShare * box.diagonal().norm();
}

Eigen::AlignedBox2d DomainOf(const NurbsSurface& surface) {
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  return {Eigen::Vector2d(u.lower(), v.lower()), Eigen::Vector2d(u.upper(), v.upper())};
}

double RangeOf(const std::vector<SurfaceMesh>& meshes) {
  std::vector<double> all;
  for (const SurfaceMesh& one : meshes)
    all.insert(all.end(), one.deviations.begin(), one.deviations.end());
  return DeviationRange(
      Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size())));
}

Eigen::Index MeasuredVertices(const std::vector<SurfaceMesh>& meshes) {
  Eigen::Index measured = 0;
  for (const SurfaceMesh& one : meshes)
    measured += one.deviations.size() - one.deviations.array().isNaN().count();
  return measured;
}

}  // namespace

bool NamesMesh(const std::string& path, const std::string& format) {
  try {
    MeshFormatOf(path, format);
    return true;
  } catch (const UsageError&) {
    return false;
  }
}

int WriteMeshOf(const MeshRequest& a) {
  const MeshFormat format = MeshFormatOf(a.out, a.out_format);
  CheckDistinct({a.out}, a.flags.json, {a.geometry, a.cloud_path});
  if (!a.cloud_path.empty() && format == MeshFormat::kStl) {
    throw UsageError("--deviation: STL holds no colours: write .ply, .glb or .obj");
  }
  if (a.cloud_path.empty() && a.deviation_range > 0) {
    throw UsageError("--deviation-range is of colours: it needs --deviation CLOUD");
  }
  if (!a.unit.empty()) CheckUnit(a.unit);
  CheckWritable(a.out);
  const NamedSurfaces named = Surfaces(a);
  const std::vector<NurbsSurface>& surfaces = named.surfaces;
  std::optional<PointCloud> cloud;
  if (!a.cloud_path.empty()) {
    cloud = ReadCloud({a.cloud_path}, ToReadOptions(a.cloud, a.flags.quiet)).cloud;
  }
  const Progress progress = MakeProgress(a.flags.quiet);
  TessellateOptions options;
  options.chord_tolerance = a.chord_tolerance > 0 ? a.chord_tolerance : DefaultTolerance(surfaces);
  std::vector<SurfaceMesh> meshes;
  const auto count = static_cast<double>(surfaces.size());
  options.progress = [&](double share) {
    Report(progress, "tessellate", (static_cast<double>(meshes.size()) + share) / count);
  };
  Eigen::Index vertices = 0, triangles = 0;
  for (const NurbsSurface& surface : surfaces) {
    options.progress(0);
    TriangleMesh mesh = Tessellate(surface, options);
    options.max_triangles -= mesh.triangles.cols();
    vertices += mesh.vertices.cols();
    triangles += mesh.triangles.cols();
    meshes.push_back(
        {.mesh = std::move(mesh), .name = named.names[meshes.size()], .domain = DomainOf(surface)});
  }
  MeshWriteOptions write{.format = a.out_format,
                         .metres = LengthUnitOf(named.unit).millimetres / 1000};
  if (cloud) {
    ThreadPool pool(a.threads);
    AddDeviations(surfaces, *cloud, meshes, pool, progress);
    write.range = a.deviation_range > 0 ? a.deviation_range : RangeOf(meshes);
  }
  Report(progress, "write", 0);
  WriteMeshes(meshes, a.out, write);
  ClearProgress();
  if (a.flags.json) {
    nlohmann::ordered_json entry{{"path", a.out},
                                 {"kind", "mesh"},
                                 {"surfaces", surfaces.size()},
                                 {"vertices", vertices},
                                 {"triangles", triangles},
                                 {"chord_tolerance", options.chord_tolerance}};
    if (cloud) {
      entry["deviation"] = {{"points", cloud->size()},
                            {"range", write.range},
                            {"vertices_measured", MeasuredVertices(meshes)}};
    }
    PrintFiles(entry);
  } else if (!a.flags.quiet && a.out != "-") {
    PrintResult(fmt::format(
        "{}: {} triangles, {} vertices, within {:.3g} of {}",
        a.out,
        triangles,
        vertices,
        options.chord_tolerance,
        surfaces.size() == 1 ? "the surface" : fmt::format("{} surfaces", surfaces.size())));
    if (cloud) {
      fmt::print(
          "coloured by {} points: blue is {:.3g} below the surface, red above; {} vertices "
          "have none near and are grey\n",
          cloud->size(),
          write.range,
          vertices - MeasuredVertices(meshes));
    }
  }
  return kDone;
}

}  // namespace batten::internal
