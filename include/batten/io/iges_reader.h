// SPDX-License-Identifier: MIT
// Curves and surfaces from an IGES file.
#pragma once

#include <string>
#include <vector>

#include "batten/io/geometry_types.h"

namespace batten {

// Every surface and every curve outside surfaces, in the file's order and own unit: rational
// B-spline surfaces (type 128), planes inside boundaries (108), ruled ones (118), those of
// revolution (120) and tabulated cylinders (122), trimmed ones (144 with 142, 143 with 141),
// B-spline curves (126), lines (110), polylines (106), circles (100), ellipses (104), parametric
// splines (112) and composites of them (102, one curve a part), placed where a matrix (124) says. A
// file with solids (186) or surfaces and curves of other types is read by OpenCASCADE, bodies and
// all. Numbers of B-splines come as they stand. A loop of several curves is joined to one; a face
// whose one loop runs round its whole domain comes untrimmed. The path "-" is standard input.
// Throws ReadError for what is not fixed ASCII IGES, is truncated or damaged, or holds no geometry;
// a surface or curve that can't be read is among the unread. Names are name properties (406, form
// 15), else labels, of the surface or curve or, of a trimmed surface without, of the one it trims.
// The unit is that of the global section, inches where that names none, as the specification has
// it.
GeometryContents ReadIgesContents(const std::string& path);

// All of them: ReadError where one can't be read.
std::vector<Geometry> ReadIges(const std::string& path);

}  // namespace batten
