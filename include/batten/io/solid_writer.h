// SPDX-License-Identifier: MIT
// Solids as STEP files.
#pragma once

#include <string>

#include "batten/fitting/trimmed_solid.h"
#include "batten/geometry/solid_model.h"
#include "batten/io/geometry_types.h"

namespace batten {

// Writes the solid's closed shells as a MANIFOLD_SOLID_BREP each, faces sharing their edges and
// vertices. Before the file gets its name OpenCASCADE has to find every solid valid with every edge
// used by two faces and a positive volume, and to read the same number of solids, faces and edges,
// valid and of the same volume, back from the text. Open shells are OPEN_SHELLs, their area counts.
// Throws WriteError with the reason where any of that fails, and where the file can't be written;
// UsageError for an unknown unit or schema, and for a format other than STEP; then nothing is
// written. The path "-" is standard output.
void WriteSolid(const SolidModel& solid,
                const std::string& path,
                const GeometryWriteOptions& options = {});

// The same of a solid of trimmed analytic faces, whose planes, cylinders, cones, spheres, tori,
// segments and arcs stay such in the file. Returns what it has.
SolidCensus WriteSolid(const TrimmedSolid& solid,
                       const std::string& path,
                       const GeometryWriteOptions& options = {});

// What that solid has, proved in the same way, with nothing written. Throws WriteError with the
// reason where it is no solid.
SolidCensus CensusOf(const TrimmedSolid& solid);

}  // namespace batten
