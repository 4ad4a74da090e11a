// SPDX-License-Identifier: MIT
// OpenCASCADE turns the text of a B-rep file into curves and surfaces.
#pragma once

#include <string>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// What ReadBrepContents gives of a file that holds this text, which CheckedBrep has let through.
// Throws ReadError, which calls the file `name`.
GeometryContents ImportBrep(std::string text, const std::string& name);

}  // namespace batten::internal
