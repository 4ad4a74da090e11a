// SPDX-License-Identifier: MIT
#include "geometry/construction/one_sided_curve.h"

#include <algorithm>

#include "batten/geometry/closure.h"
#include "batten/geometry/split.h"

namespace batten::internal {

OneSidedCurve::OneSidedCurve(const NurbsCurve<3>& curve) : pieces_(Decompose(curve)) {
  for (const NurbsCurve<3>& piece : pieces_) begins_.push_back(piece.basis().lower());
}

CurveJet<3> OneSidedCurve::JetAt(double u, Side side) const {
  const auto above = side == Side::kBelow ? std::ranges::lower_bound(begins_, u)
                                          : std::ranges::upper_bound(begins_, u);
  const std::ptrdiff_t piece = std::max<std::ptrdiff_t>(above - begins_.begin() - 1, 0);
  return pieces_[piece].JetAt(u);
}

std::vector<FunctionBreak> BreaksOf(const NurbsCurve<3>& curve) {
  std::vector<FunctionBreak> breaks = {{curve.basis().lower()}};
  for (const KnotContinuity& knot : ContinuityAtKnots(curve)) {
    if (knot.actual < 2 && knot.actual < curve.basis().degree()) {
      breaks.push_back({knot.knot, std::max(knot.actual, 0)});
    }
  }
  breaks.push_back({curve.basis().upper()});
  return breaks;
}

}  // namespace batten::internal
