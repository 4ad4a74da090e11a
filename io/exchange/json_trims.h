// SPDX-License-Identifier: MIT
// The trim loops of a surface's entry. Not installed.
#pragma once

#include "batten/geometry/nurbs_surface.h"
#include "io/base/json_field.h"

namespace batten::internal {

// The surface with the loops its entry names as `trims`: splines, "freeform" polygons of points,
// and "container"s of both, which follow one another to one loop, either way round. Ends within
// 1e-6 of the domain are moved together. The largest loop is the outer boundary, whatever
// `reversed` says (writers differ in what it means); loops beside one another are holes in the
// whole domain. Throws ReadError naming the field and, where a loop does not close, the gap.
NurbsSurface ReadTrimmed(const JsonField& entry, NurbsSurface surface);

}  // namespace batten::internal
