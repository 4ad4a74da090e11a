// SPDX-License-Identifier: MIT
#include "cli/arguments/mesh_output.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/bounding_box.h"
#include "batten/geometry/chord_proof.h"
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

Eigen::Index AllVertices(const std::vector<SurfaceMesh>& meshes) {
  Eigen::Index vertices = 0;
  for (const SurfaceMesh& one : meshes) vertices += one.mesh.vertices.cols();
  return vertices;
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

std::string MeshWords(const MeshSummary& summary) {
  return fmt::format(
      "{} triangles, {} vertices, within {:.3g} of {}{}",
      summary.census.triangles,
      summary.census.vertices,
      summary.chord_tolerance,
      summary.surfaces == 1 ? "the surface" : fmt::format("{} surfaces", summary.surfaces),
      summary.census.open_edges == 0 ? ", watertight" : "");
}

double DefaultChordTolerance(const std::vector<NurbsSurface>& surfaces) {
  constexpr double kShare = 1e-3;
  Eigen::AlignedBox3d box;
  for (const NurbsSurface& surface : surfaces) box.extend(BoundingBox(surface));
  return kShare * box.diagonal().norm();
}

MeshSummary TessellateAll(const NamedSurfaces& named,
                          double chord_tolerance,
                          const Progress& progress,
                          std::vector<SurfaceMesh>& meshes) {
  const std::vector<NurbsSurface>& surfaces = named.surfaces;
  MeshSummary summary{.surfaces = surfaces.size(), .chord_tolerance = chord_tolerance};
  meshes.resize(surfaces.size());
  for (size_t k = 0; k < surfaces.size(); ++k) {
    meshes[k].name = named.names[k];
    meshes[k].domain = DomainOf(surfaces[k]);
  }
  TessellateOptions options;
  options.chord_tolerance = chord_tolerance;
  double done = 0, doing = 1;  // surfaces
  options.progress = [&](double share) {
    Report(progress, "tessellate", (done + doing * share) / static_cast<double>(surfaces.size()));
  };
  std::vector<bool> in_body(surfaces.size());
  int joints = 0;
  for (const GeometryBody& body : named.bodies) {
    if (body.borders.empty()) continue;
    doing = static_cast<double>(body.surfaces.size());
    std::vector<NurbsSurface> faces;
    for (const size_t k : body.surfaces) faces.push_back(surfaces[k]);
    ShellMesh shell = TessellateShell(faces, body.borders, options);
    const int before = joints;
    for (size_t k = 0; k < faces.size(); ++k) {
      for (int& joint : shell.joints[k]) {
        if (joint >= 0) joints = std::max(joints, (joint += before) + 1);
      }
      SurfaceMesh& one = meshes[body.surfaces[k]];
      options.max_triangles -= shell.faces[k].triangles.cols();
      one.mesh = std::move(shell.faces[k]);
      one.joints = std::move(shell.joints[k]);
      in_body[body.surfaces[k]] = true;
    }
    summary.gap = std::max(summary.gap, shell.gap);
    done += doing;
  }
  doing = 1;
  for (size_t k = 0; k < surfaces.size(); ++k) {
    if (in_body[k]) continue;
    meshes[k].mesh = Tessellate(surfaces[k], options);
    options.max_triangles -= meshes[k].mesh.triangles.cols();
    ++done;
  }
  summary.census = CensusOf(meshes);
  return summary;
}

void CertifyMeshes(const std::vector<NurbsSurface>& surfaces,
                   const std::vector<SurfaceMesh>& meshes,
                   double chord_tolerance,
                   CertificateSummary& summary) {
  constexpr double kAbove = 1 + 1e-6;  // planes of rounded vertices
  size_t open = 0;
  double reach = 0;
  for (size_t k = 0; k < surfaces.size(); ++k) {
    open += UnprovedTriangles(surfaces[k], meshes[k].mesh, kAbove * chord_tolerance).size();
    reach = std::max(reach, meshes[k].mesh.vertices.colwise().norm().maxCoeff());
  }
  if (open > 0) {
    summary.unproved.push_back(
        fmt::format("mesh: {} triangles whose distance from the surface is not proved", open));
    return;
  }
  summary.mesh_chord = kAbove * chord_tolerance + reach * std::numeric_limits<float>::epsilon();
}

double MetresIn(const std::string& unit) {
  return LengthUnitOf(unit.empty() ? "mm" : unit).millimetres / 1000;
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
  BeginReading({a.geometry}, a.flags.quiet);
  const GeometryContents contents = ReadInUnit(a.geometry,
                                               a.geometry_format,
                                               {.unit = a.unit, .input = a.input},
                                               a.flags.quiet,
                                               Kept::kBodies);
  const NamedSurfaces named =
      SurfacesAlone(a.geometry, contents, "curves have no mesh", a.flags.quiet);
  const std::vector<NurbsSurface>& surfaces = named.surfaces;
  std::optional<PointCloud> cloud;
  if (!a.cloud_path.empty()) {
    const CloudReadOptions read = ToReadOptions(a.cloud, a.flags.quiet);
    CloudFile file = ReadCloud({a.cloud_path}, read);
    RequireFixedMiddle(file, read, {a.cloud_path});
    TellRemarks(file, a.flags.quiet);
    cloud = std::move(file.cloud);
  }
  const Progress progress = MakeProgress(a.flags.quiet);
  std::vector<SurfaceMesh> meshes;
  const MeshSummary summary =
      TessellateAll(named,
                    a.chord_tolerance > 0 ? a.chord_tolerance : DefaultChordTolerance(surfaces),
                    progress,
                    meshes);
  MeshWriteOptions write{.format = a.out_format, .metres = MetresIn(contents.unit)};
  if (cloud) {
    ThreadPool pool(a.threads);
    AddDeviations(surfaces, *cloud, meshes, pool, progress);
    write.range = a.deviation_range > 0 ? a.deviation_range : RangeOf(meshes);
  }
  Report(progress, "write", 0);
  WriteMeshes(meshes, a.out, write);
  ClearProgress();
  constexpr double kCounted = 0.25;  // of the chord tolerance: ShellMesh::gap
  if (!a.flags.quiet && summary.gap > kCounted * summary.chord_tolerance) {
    PrintWarning(fmt::format(
        "{}: faces are up to {:.3g} apart along the edges they share: the mesh is that much "
        "farther from them there",
        a.geometry,
        summary.gap));
  }
  if (a.flags.json) {
    nlohmann::ordered_json entry{{"path", a.out},
                                 {"kind", "mesh"},
                                 {"surfaces", summary.surfaces},
                                 {"vertices", summary.census.vertices},
                                 {"triangles", summary.census.triangles},
                                 {"open_edges", summary.census.open_edges},
                                 {"chord_tolerance", summary.chord_tolerance}};
    if (cloud) {
      entry["deviation"] = {{"points", cloud->size()},
                            {"range", write.range},
                            {"vertices_measured", MeasuredVertices(meshes)}};
    }
    PrintFiles(entry);
  } else if (!a.flags.quiet && a.out != "-") {
    PrintResult(a.out + ": " + MeshWords(summary));
    if (cloud) {
      fmt::print(
          "coloured by {} points: blue is {:.3g} below the surface, red above; {} vertices "
          "have none near and are grey\n",
          cloud->size(),
          write.range,
          AllVertices(meshes) - MeasuredVertices(meshes));
    }
  }
  return kDone;
}

}  // namespace batten::internal
