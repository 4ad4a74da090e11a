// SPDX-License-Identifier: MIT
#include "io/cloud/glb_vertices.h"

#include <string>
#include <utility>
#include <vector>

#include "io/cloud/glb_reader.h"
#include "io/cloud/vertex_rows.h"

namespace batten::internal {

FileCloud ReadGlb(ByteSource& source, const CloudReadOptions& options) {
  std::string bytes;
  for (std::string_view next = source.Peek(1); !next.empty(); next = source.Peek(1)) {
    bytes += next;
    source.Skip(static_cast<std::int64_t>(next.size()));
  }
  const PolygonMesh mesh = PolygonsOfGlb(bytes, source.name());
  std::vector<VertexRows> groups;
  groups.emplace_back(3);
  for (const auto vertex : mesh.vertices.colwise())
    Eigen::Map<Eigen::Vector3d>(groups[0].Add()) = vertex;
  const std::vector<CloudField> fields{{.name = "x"}, {.name = "y"}, {.name = "z"}};
  CloudFilter filter(source.name(),
                     fields,
                     ChooseColumns(source.name(), fields, FieldNaming::kProperties, options),
                     options,
                     RowPlace::kVertex);
  FeedRows(std::move(groups), filter);
  FileCloud cloud = std::move(filter).Finish();
  cloud.remarks.push_back("glTF is in metres and has y up: x, y and z are metres here (say --unit m), z up");
  return cloud;
}

}  // namespace batten::internal
