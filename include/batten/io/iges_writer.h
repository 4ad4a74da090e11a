// SPDX-License-Identifier: MIT
// Curves and surfaces as an IGES file.
#pragma once

#include <string>
#include <vector>

#include "batten/io/geometry_types.h"

namespace batten {

// Writes IGES 5.3: surfaces as rational B-spline surfaces (type 128), trimmed ones as trimmed
// surfaces (144) with a curve on the surface (142) for every loop, curves as rational B-spline
// curves (126), plane ones at z = 0; in order. Knots, control points, weights and loops are written
// as they are, with all their digits; what is periodic is clamped and closed. Beside each loop in
// the parameters stands the curve in space that follows it, to 1e-9 of the size. The numbers in the
// file are the data's, declared to be in `unit`. The same geometry gives the same bytes: the time
// stamp is SOURCE_DATE_EPOCH or 1970. Throws UsageError for an unknown unit, WriteError when the
// file can't be written, std::invalid_argument without geometry. The path "-" is standard output.
void WriteIges(const std::vector<Geometry>& geometry,
               const std::string& path,
               const std::string& unit = "mm");

// The same with names: properties (406, form 15), and labels of their first eight characters.
void WriteIges(const GeometryFile& file, const GeometryWriteOptions& options);

}  // namespace batten
