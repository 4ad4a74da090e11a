// SPDX-License-Identifier: MIT
// Trim loops cut by a parameter line. Internal to geometry.
#pragma once

#include <vector>

#include "batten/geometry/direction.h"
#include "geometry/editing/monotone_arcs.h"
#include "geometry/editing/trim_maps.h"

namespace batten::internal {

// Which side of a parameter line is kept.
enum class KeptSide { kBelow, kAbove };

// What is left of a trimmed domain on one side of the line u = at (direction kU) or v = at: one set
// of loops, turned as NurbsSurface describes them, for every connected part; none where nothing is
// left. Loops that do not reach the line stay. Others are cut where they cross it, by knots in
// them, and joined along it by straight pieces, with knots of multiplicity p between.
//
// What comes to within 1e-10 of the domain's length of the line ends there: thinner slivers are
// dropped, and parts that only touch stay apart or together as their loops have it. Loops must be
// turned and not cross each other; throws std::invalid_argument where that shows. O(arcs log arcs),
// and the cutting of each curve.
std::vector<TrimLoops> CutTrims(const TrimLoops& loops,
                                const UnitDomain& domain,
                                Direction direction,
                                double at,
                                KeptSide side);

// Whether one loop is all there is and runs along the domain's sides only, to 1e-10 of the domain:
// then it trims nothing away.
bool FillsDomain(const TrimLoops& loops, const UnitDomain& domain);

}  // namespace batten::internal
