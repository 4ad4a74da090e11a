// SPDX-License-Identifier: MIT
// Curves and surfaces as edges and faces. Not installed; includes OpenCASCADE.
#pragma once

#include <TopoDS_Shape.hxx>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// The edge on a curve, the face on a surface, or the faces of its regions: analytic where it is
// exactly that, clamped and closed where it is periodic, with the smallest tolerance, by powers of
// ten from OpenCASCADE's own 1e-7 to a millionth of its size, at which it is valid: with large
// coordinates or high degrees rounding exceeds 1e-7. Throws Standard_Failure where there is none.
TopoDS_Shape ValidShape(const Geometry& geometry);

// Throws Standard_Failure that says so, and what to do.
[[noreturn]] void FailAsTooSmall(double size);

}  // namespace batten::internal
