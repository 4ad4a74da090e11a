// SPDX-License-Identifier: MIT
// Entries of the exchange form in powers of the parameter: "form": "power". Not installed.
#pragma once

#include <string>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/io/geometry_types.h"
#include "io/base/json_field.h"

namespace batten::internal {

// {"type": "spline", "form": "power", "rational", "dimension", "degree", "breaks",
//  "coefficients": {"points": [[…], …][, "weights": […]]}}, surfaces with degree_u, breaks_u and so
// on: the members of PowerCurve and PowerSurface (power_form.h), their coefficients in that order;
// "weights" are those of w where the shape is rational. Becomes a B-spline in Bézier form. Throws
// ReadError naming the field, std::invalid_argument where FromPower does.
bool IsPower(const JsonField& entry);
Geometry ReadJsonPower(const JsonField& entry, bool surface);

// The entry of a shape. Throws std::invalid_argument where ToPower does.
std::string PowerEntry(const Geometry& geometry);

}  // namespace batten::internal
