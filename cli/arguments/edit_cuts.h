// SPDX-License-Identifier: MIT
// What `batten edit` does where a plane or a curve cuts a shape.
#pragma once

#include <vector>

#include "batten/io/geometry_types.h"
#include "cli/arguments/edit_syntax.h"

namespace batten::internal {

// The pieces of a curve or surface above and below the plane of a `cut`, those above first, as far
// as they are to be kept; a shape that is not cut comes whole. Throws UsageError where nothing is
// left.
std::vector<Geometry> CutPieces(const EditOperation& operation, const Geometry& shape);

// The pieces of a surface inside or outside the curves in the file of a `trim`. Inside an open
// curve is its left in (u, v). Throws UsageError where the curve does not cut the surface, and
// ReadError for the file.
std::vector<Geometry> TrimmedPieces(const EditOperation& operation, const NurbsSurface& surface);

}  // namespace batten::internal
