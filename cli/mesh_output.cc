// SPDX-License-Identifier: MIT
#include "batten/cli/mesh_output.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "batten/cli/fit_output.h"
#include "batten/cli/terminal.h"
#include "batten/geometry/bounding_box.h"
#include "batten/geometry/tessellate.h"
#include "batten/io/geometry_file.h"
#include "batten/io/mesh_writer.h"
#include "batten/io/read_error.h"

namespace batten {
namespace {

// The surfaces of the file; curves have no mesh.
std::vector<NurbsSurface> Surfaces(const MeshRequest& a) {
  BeginReading({a.geometry}, a.flags.quiet);
  const std::vector<Geometry> geometry = ReadGeometry(a.geometry, {a.geometry_format});
  std::vector<NurbsSurface> surfaces;
  for (const Geometry& one : geometry) {
    if (const auto* surface = std::get_if<NurbsSurface>(&one)) surfaces.push_back(*surface);
  }
  if (surfaces.empty()) throw ReadError(a.geometry, "holds no surface, only curves");
  if (surfaces.size() < geometry.size() && !a.flags.quiet) {
    PrintWarning(fmt::format("{}: {} curves are left out: they have no mesh",
                             a.geometry,
                             geometry.size() - surfaces.size()));
  }
  return surfaces;
}

double DefaultTolerance(const std::vector<NurbsSurface>& surfaces) {
  constexpr double kShare = 1e-3;
  Eigen::AlignedBox3d box;
  for (const NurbsSurface& surface : surfaces) box.extend(BoundingBox(surface));
  return kShare * box.diagonal().norm();
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
  MeshFormatOf(a.out, a.out_format);
  if (a.flags.json && a.out == "-") throw UsageError("-o - and --json both want standard output");
  CheckWritable(a.out);
  const std::vector<NurbsSurface> surfaces = Surfaces(a);
  const Progress progress = MakeProgress(a.flags.quiet);
  TessellateOptions options;
  options.chord_tolerance = a.chord_tolerance > 0 ? a.chord_tolerance : DefaultTolerance(surfaces);
  std::vector<TriangleMesh> meshes;
  const auto count = static_cast<double>(surfaces.size());
  options.progress = [&](double share) {
    Report(progress, "tessellate", (static_cast<double>(meshes.size()) + share) / count);
  };
  for (const NurbsSurface& surface : surfaces) {
    options.progress(0);
    TriangleMesh mesh = Tessellate(surface, options);
    options.max_triangles -= mesh.triangles.cols();
    meshes.push_back(std::move(mesh));
  }
  const TriangleMesh mesh = JoinedMeshes(meshes);
  options.progress(0);
  WriteMesh(mesh, a.out, a.out_format);
  ClearProgress();
  if (a.flags.json) {
    PrintFiles({{"path", a.out},
                {"kind", "mesh"},
                {"surfaces", surfaces.size()},
                {"vertices", mesh.vertices.cols()},
                {"triangles", mesh.triangles.cols()},
                {"chord_tolerance", options.chord_tolerance}});
  } else if (!a.flags.quiet && a.out != "-") {
    fmt::print("{}: {} triangles, {} vertices, within {:.3g} of {}\n",
               a.out,
               mesh.triangles.cols(),
               mesh.vertices.cols(),
               options.chord_tolerance,
               surfaces.size() == 1 ? "the surface" : fmt::format("{} surfaces", surfaces.size()));
  }
  return kDone;
}

}  // namespace batten
