// SPDX-License-Identifier: MIT
// Curves and surfaces as JSON text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "batten/io/geometry_types.h"

namespace batten {

// The exchange form of NURBS-Python (geomdl): {"shape": {"type", "count", "data": [entry, …]}}. An
// entry with `degree` is a curve (dimension 2 or 3), one with `degree_u` a surface; points are
// Euclidean, a surface's v index runs fastest, missing weights are ones, names not of the form are
// ignored. A direction that `periodic` says to be so has knots and control points that repeat (see
// SplineBasis::Periodic); points and weights that do so up to the rounding of decimals, 1e-12 of
// the size, are made to repeat exactly. A surface's `trims` are loops in its parameter domain, each
// a curve or a container of curves that make one loop; ends within 1e-6 of the domain are moved
// together, and the loops are turned as NurbsSurface::trims says. Throws ReadError naming `path`
// and the field, as in `shape.data[0].knotvector_u`, or the line; coordinates above 1e150 in
// magnitude are refused.
// An entry of "form": "power" becomes a B-spline in Bézier form (power_form.h).
// An entry's `name` and the shape's `unit`, both of batten, are kept in the contents.
GeometryContents ParseJsonContents(std::string_view text, const std::string& path);
std::vector<Geometry> ParseGeometryJson(std::string_view text, const std::string& path);

// The same form; numbers in the shortest decimal form that reads back bit by bit, `periodic` only
// where a direction is. The shape's type is "mixed" when curves and surfaces stand together, which
// NURBS-Python does not read. Names are written where there are any, the unit where it is not mm.
// With `powers` every entry is in powers of the parameter, "form": "power" (docs/files.md), as
// WriteGeometry writes them in the format "json-power".
// Throws std::invalid_argument without geometry, and with powers as ToPower (power_form.h).
std::string ToGeometryJson(const GeometryFile& file,
                           const std::string& unit = "mm",
                           bool powers = false);
std::string ToGeometryJson(const std::vector<Geometry>& geometry);

}  // namespace batten
