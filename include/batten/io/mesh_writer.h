// SPDX-License-Identifier: MIT
// Triangle meshes into files.
#pragma once

#include <string>
#include <vector>

#include "batten/geometry/tessellate.h"
#include "batten/io/surface_mesh.h"

namespace batten {

enum class MeshFormat {
  kObj,  // .obj: text; numbers that read back exactly, with parameters (vt) and normals (vn)
  kStl,  // .stl: binary; single precision, far origins lose digits; a normal for every triangle
  kPly,  // .ply: binary little-endian, doubles; nx ny nz, u v, triangles as lists
  kGlb,  // .glb: glTF 2.0, binary; see glb_writer.h
};

// The format named by the word (obj, stl, ply, glb; any case) or, when that is empty, by the
// extension of the path. Throws UsageError where it is none of these.
MeshFormat MeshFormatOf(const std::string& path, const std::string& format = "");

struct MeshWriteOptions {
  std::string format = {};  // a word, as above
  double metres = 1e-3;     // in a unit of the coordinates: GLB is in metres
  double range = 0;  // deviations of that size get the last colours; 0: DeviationRange of them all
};

// Writes meshes whole or not at all; "-" is standard output. OBJ and GLB keep them apart, as
// objects of their names; PLY and STL hold all triangles in their order. Vertices that are the same
// point (SurfaceMesh::joints) are one in OBJ and PLY, there with the normal and parameters of the
// first of them; GLB, which has normals by vertex, and STL repeat its coordinates. Where there are
// deviations vertices are coloured by them (DeviationColour), in PLY beside properties `deviation`
// and `measured` (0 where there is none; the deviation is then 0 too). Throws WriteError;
// UsageError as above and for deviations in STL, which has no colours; std::invalid_argument where
// sizes do not agree.
void WriteMeshes(const std::vector<SurfaceMesh>& meshes,
                 const std::string& path,
                 const MeshWriteOptions& options = {});

// One mesh alone.
void WriteMesh(const TriangleMesh& mesh, const std::string& path, const std::string& format = "");

}  // namespace batten
