// SPDX-License-Identifier: MIT
// The faces of mesh files.
#pragma once

#include <string>

#include "batten/geometry/quad_mesh.h"
#include "batten/io/polygon_mesh.h"

namespace batten {

// Reads the vertices and faces of .obj, .off, .ply (ASCII and binary), .stl (both, with equal
// corners joined) and .glb (the same, in metres and z up), by the path's extension; none of a file
// without faces. All else in a file is passed over. Memory grows with what the file holds, never
// with what a header promises. Throws ReadError naming line or byte where a file can't be read, a
// face has fewer than three vertices or names one that is not there, or a coordinate is not finite;
// UsageError for other extensions.
PolygonMesh ReadPolygons(const std::string& path);

// Whether the file may hold faces, by its extension and, of a .ply file that is there, its header.
// Of a path that is no regular file the extension alone decides.
bool MayHoldFaces(const std::string& path);

// The same of a layout: throws ReadError where there are no faces, or one has other than four
// vertices.
QuadMesh ReadQuadMesh(const std::string& path);

// Writes an OBJ file of vertices and faces, whole or not at all. Throws WriteError.
void WriteQuadMesh(const QuadMesh& mesh, const std::string& path);

}  // namespace batten
