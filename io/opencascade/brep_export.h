// SPDX-License-Identifier: MIT
// OpenCASCADE turns curves and surfaces into the text of a B-rep file.
#pragma once

#include <optional>
#include <string>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// As brep_writer.h says; `sew` is that of GeometryWriteOptions. Throws WriteError naming the file's
// path where no valid B-rep can be built.
std::string ExportBrep(const GeometryFile& file,
                       const std::optional<double>& sew,
                       std::optional<SewingReport>& report);

}  // namespace batten::internal
