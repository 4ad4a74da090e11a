// SPDX-License-Identifier: MIT
// Directions in which the faces of a layout are to run.
#pragma once

#include <vector>

#include "fitting/solid/triangle_topology.h"

namespace batten::internal {

// A cross of four directions at right angles for every triangle: the angle of one of them from the
// triangle's first half-edge. As smooth as can be, with a pull towards the directions of principal
// curvature where these differ by much over the length of a face; pairs of singular places nearer
// to each other than about that length go. Crosses run along creases. O(n^1.5).
// [Knöppel, Crane, Pinkall & Schröder 2013; diffusion: Viertel & Osting 2019]
std::vector<double> SmoothCrosses(const TriangleSurface& surface,
                                  const TriangleTopology& topology,
                                  double face_length,
                                  const std::vector<char>& creases);  // by half-edge

}  // namespace batten::internal
