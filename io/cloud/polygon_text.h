// SPDX-License-Identifier: MIT
// The bytes of mesh files.
#pragma once

#include <string>
#include <string_view>

namespace batten {
struct PolygonMesh;
}

namespace batten::internal {

// What ReadPolygons reads, of bytes in memory: `extension` is .obj, .off, .ply, .stl or .glb, and
// `path` is what errors name.
PolygonMesh PolygonsOfText(std::string_view bytes,
                           const std::string& extension,
                           const std::string& path);

}  // namespace batten::internal
