// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/editing/monotone_arcs.h"
#include "geometry/section/plane_curve_crossings.h"
#include "batten/geometry/plane_section.h"
#include "batten/geometry/split.h"
#include "batten/geometry/trim_region.h"

namespace batten {
using namespace internal;
namespace {

NurbsCurve<2> InUnitSquare(const NurbsCurve<2>& curve, const UnitDomain& domain) {
  NurbsCurve<2>::Points points = curve.control_points();
  for (Eigen::Index k = 0; k < points.cols(); ++k) points.col(k) = domain(points.col(k).eval());
  return NurbsCurve<2>(curve.basis(), std::move(points), curve.weights());
}

// The stretches of one curve inside the loops, between its crossings with them.
void AddInside(const SectionCurve& curve,
               const NurbsSurface& surface,
               const TrimRegion& region,
               std::vector<SectionCurve>& kept) {
  constexpr double kOne = 1e-11, kShort = 1e-9;
  const UnitDomain domain(surface);
  const SplineBasis& basis = curve.parameters.basis();
  const NurbsCurve<2> unit = InUnitSquare(curve.parameters, domain);
  std::vector<double> cuts{basis.lower(), basis.upper()};
  for (const NurbsCurve<2>& loop : surface.trims()) {
    for (const CurveCrossing& one : CurveCrossings(InUnitSquare(loop, domain), unit, kOne)) {
      cuts.push_back(one.t);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  const double least = kShort * (basis.upper() - basis.lower());
  // A stretch grows until what comes next lies outside.
  double from = cuts.front(), to = from;
  const auto take = [&] {
    if (to - from <= least) return;
    const bool all = from == basis.lower() && to == basis.upper();
    kept.push_back(all ? curve
                       : SectionCurve{Segment(curve.parameters, from, to),
                                      Segment(curve.points, from, to),
                                      false});
  };
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const Eigen::Vector2d middle = curve.parameters.At((cuts[k] + cuts[k + 1]) / 2);
    if (cuts[k + 1] - cuts[k] > least && !region.Contains(middle[0], middle[1])) {
      take();
      from = cuts[k + 1];
    }
    to = cuts[k + 1];
  }
  take();
}

}  // namespace

PlaneSection SectionInside(const NurbsSurface& surface, PlaneSection section) {
  if (!surface.trimmed()) return section;
  const TrimRegion region(surface);
  for (std::vector<SectionCurve>* curves : {&section.curves, &section.edges}) {
    std::vector<SectionCurve> kept;
    for (const SectionCurve& curve : *curves) AddInside(curve, surface, region, kept);
    *curves = std::move(kept);
  }
  return section;
}

}  // namespace batten
