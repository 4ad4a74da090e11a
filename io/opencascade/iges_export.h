// SPDX-License-Identifier: MIT
// OpenCASCADE turns curves and surfaces into the text of an IGES file.
#pragma once

#include <string>

#include "batten/io/geometry_types.h"
#include "batten/io/length_unit.h"

namespace batten::internal {

// The geometry with its names, as iges_writer.h says. Throws WriteError naming the file's path
// where OpenCASCADE finds no curve in space that follows a loop.
std::string ExportIges(const GeometryFile& file, const LengthUnit& unit);

}  // namespace batten::internal
