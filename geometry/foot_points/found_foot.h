// SPDX-License-Identifier: MIT
// The result of a search for the closest point, in the terms of a FootTable. Internal.
#pragma once

namespace batten::internal {

// The closest point found: piece, local parameters, and distances; nothing lies nearer than
// `lower_bound`.
struct FoundFoot {
  int piece;
  double x, y;
  double distance, lower_bound;
  double gx = 0, gy = 0;  // of |S − q|²/2, less what only leads out of the surface
};

}  // namespace batten::internal
