// SPDX-License-Identifier: MIT
// Curves that run, and closed ones that begin, beside one another.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten {

// What was done to a curve so that it runs beside the one before.
struct CurveAlignment {
  bool reversed = false;
  double start = 0;  // share of the domain, of the curve as it then runs, by which it begins later
};

struct AlignedCurves {
  std::vector<NurbsCurve<3>> curves;
  std::vector<CurveAlignment> changes;  // one for each curve; the first is never changed
};

// Every curve turned round, and every closed one begun elsewhere, where that brings its points
// nearer to those of the one before at equal shares of the domain (both about their own middles;
// the sum of squares at 64 places). Where nothing is gained, or less than a fiftieth, the curve
// stays bit by bit. Closed curves stay smooth where they were; the old start becomes a knot. Throws
// std::invalid_argument where one is closed and another is not, naming both and the gap.
// O(curves · 64²).
AlignedCurves Aligned(std::vector<NurbsCurve<3>> curves);

}  // namespace batten
