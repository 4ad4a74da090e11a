// SPDX-License-Identifier: MIT
// A trim loop in the pieces that become edges of a face. Not installed.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// A side of the domain.
enum class Side { kNone, kULower, kUUpper, kVLower, kVUpper };

// A part of a loop, clamped, with the loop's parameters, and the side that it runs along, to 1e-9
// of the domain.
struct TrimPiece {
  NurbsCurve<2> curve;
  Side side;
};

// The loop cut where it has corners (where its direction turns at a knot of multiplicity p) and
// where it comes upon a side or leaves it. Pieces follow one another; one at least.
std::vector<TrimPiece> TrimPieces(const NurbsSurface& surface, const NurbsCurve<2>& loop);

// The same with pieces along the sides of a direction that closes cut so that either side has cuts
// at the same places: what lies on both sides is then one piece on each.
void MatchSides(std::vector<std::vector<TrimPiece>>& loops, Side lower, Side upper);

}  // namespace batten::internal
