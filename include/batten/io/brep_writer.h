// SPDX-License-Identifier: MIT
// Curves and surfaces as a B-rep file of OpenCASCADE.
#pragma once

#include <optional>

#include "batten/io/geometry_types.h"

namespace batten {

// Writes a .brep file, version 1, as FreeCAD, DRAW and OpenCASCADE's own programs read it: the
// faces and edges that WriteStep makes, sewn as that says, in a compound where there are several.
// The format has no place for names and units. The same geometry gives the same bytes. Throws as
// WriteStep does. The path "-" is standard output.
std::optional<SewingReport> WriteBrep(const GeometryFile& file,
                                      const GeometryWriteOptions& options = {});

}  // namespace batten
