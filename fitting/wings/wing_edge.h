// SPDX-License-Identifier: MIT
// The sharp edge of a thin section.
#pragma once

#include "fitting/wings/wing_places.h"

namespace batten::internal {

// Moves the frame's edge to where points end (EndOfPoints), and between the sides. `spacing` and
// `noise` of the points, in their lengths. False where no line was found. O(m).
bool MoveEdge(const WingPlaces& at, double spacing, double noise, WingFrame& frame);

// The sides in the wedge before the edge, as straight lines.
struct EdgeWedge {
  double blunt;  // the sides' distance left at the edge, over that amid the wedge; infinite if
                 // points are too few
  double slope;  // of either side against the chord
};
EdgeWedge WedgeAtEdge(const WingPlaces& at, const WingFrame& frame, double noise);

}  // namespace batten::internal
