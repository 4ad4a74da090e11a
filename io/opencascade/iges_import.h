// SPDX-License-Identifier: MIT
// IGES in, as OpenCASCADE reads it. Not installed.
#pragma once

#include <string>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// The shapes of the text, B-rep solids (186, 514) among them, in the file's unit, which the
// contents do not tell; none where OpenCASCADE finds none, or a damaged entity. Throws ReadError
// naming `name` where it fails.
GeometryContents ImportIges(const std::string& text, const std::string& name);

}  // namespace batten::internal
