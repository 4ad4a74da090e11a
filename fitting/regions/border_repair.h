// SPDX-License-Identifier: MIT
// What every border of a body's faces keeps to, made good where points are too few to show it.
#pragma once

#include <vector>

#include "fitting/regions/face_borders.h"

namespace batten::internal {

// Of edges that no places show, those round the other side of a shape and those at a corner that
// chance makes of a face's extension go. At a vertex an even number of edges' ends is of each face.
// Two vertices a few spacings apart where that fails for the same two faces are joined along the
// border of these: an edge too short to have points. A vertex in the middle of an edge, as chance
// makes it, is none.
void RepairBorders(const FaceMeets& meets, FaceBorders& borders);

}  // namespace batten::internal
