// SPDX-License-Identifier: MIT
// Surfaces as triangle meshes in a file: what tessellate, convert and fits share.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/fitting/progress.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/io/certificate.h"
#include "batten/io/mesh_census.h"
#include "batten/io/surface_mesh.h"
#include "cli/arguments/cloud_arguments.h"
#include "cli/arguments/geometry_output.h"
#include "cli/terminal/common_flags.h"

namespace batten::internal {

struct MeshRequest {
  std::string geometry, geometry_format, out, out_format;
  double chord_tolerance = 0;   // 0: 1e-3 of the size of all surfaces
  std::string unit = {};        // wanted; empty: the geometry's own, mm where it says none
  std::string cloud_path = {};  // whose deviations colour the mesh; none without
  CloudArguments cloud = {};
  double deviation_range = 0;  // 0: a round number that 95 % are within
  int threads = 0;
  GeometryInput input = {};
  CommonFlags flags;
};

// Whether the word, or else the path, names a format of meshes.
bool NamesMesh(const std::string& path, const std::string& format);

// What became of surfaces.
struct MeshSummary {
  size_t surfaces = 0;
  MeshCensus census = {};
  double chord_tolerance = 0;
  double gap = 0;  // ShellMesh
};
// "4870 triangles, 2505 vertices, within 0.1 of the surface, watertight"
std::string MeshWords(const MeshSummary& summary);

// 1e-3 of the size of all surfaces.
double DefaultChordTolerance(const std::vector<NurbsSurface>& surfaces);

// The surfaces' meshes, in their order: those of a body have vertices in common along edges.
MeshSummary TessellateAll(const NamedSurfaces& named,
                          double chord_tolerance,
                          const Progress& progress,
                          std::vector<SurfaceMesh>& meshes);

// Adds to the summary how near the surfaces are proved to be to the planes of their meshes'
// triangles as files have them, in single precision.
void CertifyMeshes(const std::vector<NurbsSurface>& surfaces,
                   const std::vector<SurfaceMesh>& meshes,
                   double chord_tolerance,
                   CertificateSummary& summary);

// In a unit, that of no name being mm: what MeshWriteOptions asks for.
double MetresIn(const std::string& unit);

// Writes the mesh, then the line or JSON on standard output. Returns the exit code.
int WriteMeshOf(const MeshRequest& request);

}  // namespace batten::internal
