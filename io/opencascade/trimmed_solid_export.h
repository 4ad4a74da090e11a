// SPDX-License-Identifier: MIT
// OpenCASCADE turns a solid of trimmed analytic faces into the text of a STEP file, and proves it.
#pragma once

#include <string>

#include "batten/fitting/trimmed_solid.h"
#include "io/exchange/opencascade_functions.h"

namespace batten::internal {

// As ExportSolid; `census` gets what the solid has. Seams of round faces are added.
std::string ExportTrimmedSolid(const TrimmedSolid& solid,
                               const std::string& path,
                               const char* unit,
                               const char* schema,
                               SolidCensus& census);

}  // namespace batten::internal
