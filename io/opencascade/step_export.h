// SPDX-License-Identifier: MIT
// OpenCASCADE turns curves and surfaces into the text of a STEP file.
#pragma once

#include <string>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// The geometry with its names, as step_writer.h says, real numbers with 17 digits. `unit` and
// `schema` are OpenCASCADE's words. Throws WriteError naming the file's path where no valid B-rep
// can be built.
std::string ExportStep(const GeometryFile& file, const char* unit, const char* schema);

}  // namespace batten::internal
