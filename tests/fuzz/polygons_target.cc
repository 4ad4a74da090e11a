// SPDX-License-Identifier: MIT
// The reader of faces.
#include <fmt/format.h>

#include <string>

#include "batten/io/polygon_reader.h"
#include "batten/io/read_error.h"
#include "fuzz_targets.h"
#include "io/cloud/polygon_text.h"

namespace batten::internal {

void FuzzPolygons(std::string_view bytes) {
  if (bytes.empty()) return;
  const char* const extension = bytes[0] == 'o'   ? ".obj"
                                : bytes[0] == 'f' ? ".off"
                                : bytes[0] == 's' ? ".stl"
                                : bytes[0] == 'g' ? ".glb"
                                                  : ".ply";
  PolygonMesh mesh;
  try {
    mesh = PolygonsOfText(bytes.substr(1), extension, "bytes");
  } catch (const ReadError&) {
    return;
  }
  RequireLaw(mesh.vertices.allFinite(), "vertices are finite");
  // A .glb may place a mesh several times.
  RequireLaw(bytes[0] == 'g' || std::size_t(mesh.vertices.cols()) <= bytes.size(),
             "every vertex takes bytes");
  std::string text;
  for (const auto v : mesh.vertices.colwise())
    text += fmt::format("v {} {} {}\n", v[0], v[1], v[2]);
  for (const std::vector<int>& face : mesh.faces) {
    RequireLaw(face.size() >= 3, "a face has three vertices or more");
    text += "f";
    for (const int vertex : face) {
      RequireLaw(vertex >= 0 && vertex < mesh.vertices.cols(), "vertices of faces are there");
      text += fmt::format(" {}", vertex + 1);
    }
    text += "\n";
  }
  const PolygonMesh again = PolygonsOfText(text, ".obj", "text");
  RequireLaw(again.vertices == mesh.vertices && again.faces == mesh.faces,
             "what is written reads back the same");
}

}  // namespace batten::internal
