// SPDX-License-Identifier: MIT
// Curves and surfaces from a B-rep file of OpenCASCADE.
#pragma once

#include <string>

#include "batten/io/geometry_types.h"

namespace batten {

// Every face and every edge outside faces of a .brep file (BRepTools, as text, versions 1 to 3), as
// ReadStepContents gives those of STEP; its solids and shells as bodies. Such a file holds neither
// names nor a unit. Triangles are left out. The path "-" is standard input. Throws ReadError with
// the line for what is not such a file, is truncated or damaged, or holds no geometry.
// [OpenCASCADE, BRep format, 2022]
GeometryContents ReadBrepContents(const std::string& path);

}  // namespace batten
