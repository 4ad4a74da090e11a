// SPDX-License-Identifier: MIT
#include "batten/geometry/tessellate.h"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>

#include "batten/geometry/bounding_box.h"
#include "geometry/measure/narrow_spans.h"
#include "geometry/mesh/mesh_extraction.h"
#include "geometry/mesh/shell_tessellation.h"
#include "geometry/mesh/surface_tessellation.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

void CheckOptions(const TessellateOptions& options) {
  if (!(options.chord_tolerance >= 0) || !std::isfinite(options.chord_tolerance)) {
    throw std::invalid_argument("Tessellate: options.chord_tolerance: " +
                                NumberText(options.chord_tolerance) + " is not a number ≥ 0");
  }
  if (options.max_triangles <= 0) {
    throw std::invalid_argument("Tessellate: options.max_triangles: " +
                                std::to_string(options.max_triangles) + " is not positive");
  }
}

double ChordTolerance(const TessellateOptions& options, const Eigen::AlignedBox3d& box) {
  constexpr double kDefault = 1e-3;
  const double size = box.diagonal().norm();
  const double tolerance = options.chord_tolerance > 0 ? options.chord_tolerance : kDefault * size;
  if (!(tolerance > 0)) {
    throw std::invalid_argument("Tessellate: surface: all of it is one point");
  }
  return tolerance;
}

}  // namespace

TriangleMesh Tessellate(const NurbsSurface& surface, const TessellateOptions& options) {
  CheckOptions(options);
  const Eigen::AlignedBox3d box = BoundingBox(surface);
  const double tolerance = ChordTolerance(options, box);
  RefuseNarrowSpans("Tessellate", surface, tolerance);
  SurfaceTessellation one(surface, box.center(), tolerance, options);
  one.Lay();
  one.Refine();
  return ExtractMesh(one.mesh(), one.mesh().Names()).mesh;
}

ShellMesh TessellateShell(const std::vector<NurbsSurface>& surfaces,
                          const std::vector<FaceBorder>& borders,
                          const TessellateOptions& options) {
  CheckOptions(options);
  if (surfaces.empty() || borders.size() != surfaces.size()) {
    throw std::invalid_argument("TessellateShell: borders: " + std::to_string(borders.size()) +
                                " for " + std::to_string(surfaces.size()) +
                                " surfaces; one for each of at least one is needed");
  }
  Eigen::AlignedBox3d box;
  for (const NurbsSurface& surface : surfaces) box.extend(BoundingBox(surface));
  const double tolerance = ChordTolerance(options, box);
  for (const NurbsSurface& surface : surfaces) {
    RefuseNarrowSpans("TessellateShell", surface, tolerance);
  }
  return ShellTessellation(surfaces, borders, tolerance, options).Run();
}

TriangleMesh JoinedMeshes(const std::vector<TriangleMesh>& meshes) {
  Eigen::Index vertices = 0, triangles = 0;
  for (const TriangleMesh& mesh : meshes) {
    vertices += mesh.vertices.cols();
    triangles += mesh.triangles.cols();
  }
  TriangleMesh all;
  all.vertices.resize(3, vertices);
  all.parameters.resize(2, vertices);
  all.normals.resize(3, vertices);
  all.triangles.resize(3, triangles);
  Eigen::Index vertex = 0, triangle = 0;
  for (const TriangleMesh& mesh : meshes) {
    all.vertices.middleCols(vertex, mesh.vertices.cols()) = mesh.vertices;
    all.parameters.middleCols(vertex, mesh.vertices.cols()) = mesh.parameters;
    all.normals.middleCols(vertex, mesh.vertices.cols()) = mesh.normals;
    all.triangles.middleCols(triangle, mesh.triangles.cols()) =
        mesh.triangles.array() + static_cast<int>(vertex);
    const int side = static_cast<int>(all.other_sides.size());
    for (OtherSide other : mesh.other_sides) {
      other.vertex += static_cast<int>(vertex);
      all.other_sides.push_back(other);
    }
    for (SideCorner corner : mesh.side_corners) {
      corner.triangle += static_cast<int>(triangle);
      corner.side += side;
      all.side_corners.push_back(corner);
    }
    vertex += mesh.vertices.cols();
    triangle += mesh.triangles.cols();
  }
  return all;
}

}  // namespace batten
