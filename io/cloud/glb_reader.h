// SPDX-License-Identifier: MIT
// The triangles of glTF 2.0 files in binary form (.glb). Not installed.
#pragma once

#include <string>
#include <string_view>

#include "batten/io/polygon_mesh.h"

namespace batten::internal {

// All triangles and points of the file's scene, each where its node puts it, equal places joined;
// z up, which glTF has y up: (x, y, z) of the file is (x, −z, y). Lines are passed over. `path` is
// what errors name. Throws ReadError, naming the byte or the member of the document, where the file
// is damaged, or keeps what is needed in other files, compressed or sparse. [Khronos, glTF 2.0]
PolygonMesh PolygonsOfGlb(std::string_view bytes, const std::string& path);

}  // namespace batten::internal
