// SPDX-License-Identifier: MIT
// The whole reader of STEP, OpenCASCADE included.
#include "batten/io/read_error.h"
#include "batten/io/step_reader.h"
#include "fuzz_targets.h"
#include "geometry_laws.h"
#include "memory_file.h"

namespace batten::internal {

void FuzzStep(std::string_view bytes) {
  const MemoryFile file(bytes);
  std::vector<Geometry> geometry;
  try {
    geometry = ReadStep(file.path());
  } catch (const ReadError&) {
    return;
  }
  RequireGeometryLaws(geometry);
}

}  // namespace batten::internal
