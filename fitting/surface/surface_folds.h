// SPDX-License-Identifier: MIT
// Places where a surface folds back on itself.
#pragma once

#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// How many pairs of neighbouring places face away from each other; places are eight to a knot span
// in both directions, with those at the edges. None where the surface does not fold, but for folds
// that are narrower, and edges sharper than 90°. O(spans).
int FoldedPairs(const NurbsSurface& surface);

}  // namespace batten::internal
