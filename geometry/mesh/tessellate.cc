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

}  // namespace batten
