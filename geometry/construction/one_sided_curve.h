// SPDX-License-Identifier: MIT
// A curve at a knot from either side, and where it is less than smooth.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "geometry/construction/cubic_approximation.h"

namespace batten::internal {

// A curve by its Bézier pieces, so that derivatives at knots are those of the side that is meant.
class OneSidedCurve {
 public:
  explicit OneSidedCurve(const NurbsCurve<3>& curve);

  // Point and first three derivatives. O(p² + log pieces).
  CurveJet<3> JetAt(double u, Side side) const;

 private:
  std::vector<NurbsCurve<3>> pieces_;
  std::vector<double> begins_;
};

// The ends of the domain, and the knots where the curve is less than twice continuously
// differentiable: as many as the function made of it may need. In increasing order.
std::vector<FunctionBreak> BreaksOf(const NurbsCurve<3>& curve);

}  // namespace batten::internal
