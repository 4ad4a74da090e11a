// SPDX-License-Identifier: MIT
// What `batten edit` does to the form of shapes: Bézier and B-spline, continuations, chains.
#pragma once

#include <vector>

#include "batten/io/geometry_types.h"
#include "cli/arguments/edit_syntax.h"

namespace batten::internal {

// The shape with every inner knot of full multiplicity: its control points are those of its pieces.
Geometry BezierForm(const Geometry& shape);

// Without the knots that the shape does not need, to the tolerance.
Geometry BsplineForm(const EditOperation& operation, const Geometry& shape);

// Refuses what powers of the parameter would lose (power_form.h); the shape itself. The file is
// then written in powers.
Geometry PowerForm(const Geometry& shape);

// The shape and what continues it.
std::vector<Geometry> ContinuedPieces(const EditOperation& operation, const Geometry& shape);

// All curves there are, and those of the files named, as one. Throws UsageError where they do not
// make a chain or a surface is among them, and ReadError for the files.
Geometry UnifiedCurve(const EditOperation& operation, const std::vector<Geometry>& shapes);

}  // namespace batten::internal
