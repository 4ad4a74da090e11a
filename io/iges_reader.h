// SPDX-License-Identifier: MIT
// Curves and surfaces from an IGES file.
#pragma once

#include <string>
#include <vector>

#include "batten/io/geometry_file.h"

namespace batten {

// Every surface and every curve outside surfaces, in the file's order and own unit: rational
// B-spline surfaces (type 128), trimmed ones (144 with 142), B-spline curves (126), lines (110) and
// composites of them (102, one curve a part), placed where a matrix (124) says. Numbers come as
// they stand. A loop of several curves is joined to one; a face whose one loop runs round its whole
// domain comes untrimmed. The path "-" is standard input. Throws ReadError for what is not fixed
// ASCII IGES, is truncated or damaged, holds no geometry, holds surfaces or curves of other types,
// or a loop that is not closed.
std::vector<Geometry> ReadIges(const std::string& path);

}  // namespace batten
