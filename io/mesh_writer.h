// SPDX-License-Identifier: MIT
// Triangle meshes into files.
#pragma once

#include <string>

#include "batten/geometry/tessellate.h"

namespace batten {

enum class MeshFormat {
  kObj,  // .obj: text; numbers that read back exactly, with parameters (vt) and normals (vn)
  kStl,  // .stl: binary; single precision, far origins lose digits; a normal for every triangle
  kPly,  // .ply: binary little-endian, doubles; nx ny nz, u v, triangles as lists
};

// The format named by the word (obj, stl, ply; any case) or, when that is empty, by the extension
// of the path. Throws UsageError where it is none of these.
MeshFormat MeshFormatOf(const std::string& path, const std::string& format = "");

// Writes the mesh whole or not at all; "-" is standard output. Throws WriteError, or UsageError as
// above.
void WriteMesh(const TriangleMesh& mesh, const std::string& path, const std::string& format = "");

}  // namespace batten
