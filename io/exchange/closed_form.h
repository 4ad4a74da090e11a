// SPDX-License-Identifier: MIT
// What CAD files hold of periodic shapes. Not installed.
#pragma once

#include "batten/io/geometry_types.h"

namespace batten::internal {

// The same shape with clamped knots where it is periodic: closed, its ends coincide. Trims stay.
Geometry ClosedForm(const Geometry& geometry);

}  // namespace batten::internal
