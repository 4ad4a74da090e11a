// SPDX-License-Identifier: MIT
// OpenCASCADE turns curves and surfaces into the text of a STEP file.
#pragma once

#include <optional>
#include <string>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// The geometry with its names, as step_writer.h says, real numbers with 17 digits. `unit` and
// `schema` are OpenCASCADE's words; `sew` is that of GeometryWriteOptions. Throws WriteError naming
// the file's path where no valid B-rep can be built.
std::string ExportStep(const GeometryFile& file,
                       const char* unit,
                       const char* schema,
                       const std::optional<double>& sew,
                       std::optional<SewingReport>& report);

}  // namespace batten::internal
