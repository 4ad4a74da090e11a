// SPDX-License-Identifier: MIT
// The whole reader of .brep, OpenCASCADE included.
#include "batten/io/brep_reader.h"
#include "batten/io/read_error.h"
#include "fuzz_targets.h"
#include "geometry_laws.h"
#include "memory_file.h"

namespace batten::internal {

void FuzzBrep(std::string_view bytes) {
  const MemoryFile file(bytes);
  GeometryContents contents;
  try {
    contents = ReadBrepContents(file.path());
  } catch (const ReadError&) {
    return;
  }
  RequireGeometryLaws(contents.geometry);
}

}  // namespace batten::internal
