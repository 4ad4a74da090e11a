// SPDX-License-Identifier: MIT
#include "fitting/constraints/neighbour_tangents.h"

#include <utility>
#include <vector>

#include "batten/geometry/clamp.h"
#include "batten/geometry/reverse.h"
#include "fitting/constraints/neighbour_edge.h"
#include "fitting/constraints/polynomial_curve.h"
#include "fitting/core/rounding.h"

namespace batten::internal {
namespace {

constexpr int kParts = 64;

// The edge as v = upper of a clamped surface.
NurbsSurface WithEdgeOnTop(const NeighbourEdge& edge) {
  NurbsSurface surface = edge.direction == Direction::kU ? Swapped(edge.surface) : edge.surface;
  if (!edge.upper) surface = Reversed(surface, Direction::kV);
  return Clamped(Clamped(surface, Direction::kV), Direction::kU);
}

NurbsCurve<3> SampledDerivative(const NurbsSurface& surface) {
  const double v = surface.basis_v().upper();
  const std::vector<double> breaks = CutSpans(surface.basis_u(), kParts);
  const auto parts = static_cast<Eigen::Index>(breaks.size()) - 1;
  Eigen::Matrix3Xd points(3, 3 * parts + 1);
  std::vector<double> knots{breaks.front()};
  for (Eigen::Index i = 0; i < parts; ++i) {
    const double a = breaks[static_cast<size_t>(i)], b = breaks[static_cast<size_t>(i) + 1];
    // The derivative at the end is that from below.
    const SurfaceJet start = surface.JetAt(a, v),
                     end = surface.JetAt(b - kRelativelyEqual * (b - a), v);
    points.col(3 * i) = start.dv;
    points.col(3 * i + 1) = start.dv + (b - a) / 3 * start.duv;
    points.col(3 * i + 2) = end.dv - (b - a) / 3 * end.duv;
    knots.insert(knots.end(), 3, a);
  }
  points.col(3 * parts) = surface.JetAt(breaks.back(), v).dv;
  knots.insert(knots.end(), 4, breaks.back());
  return NurbsCurve<3>(SplineBasis(3, std::move(knots)), std::move(points));
}

}  // namespace

NurbsCurve<3> OutwardDerivative(const NeighbourEdge& edge) {
  const NurbsSurface surface = WithEdgeOnTop(edge);
  return surface.rational() ? SampledDerivative(surface)
                            : CrossDerivative(surface, {Direction::kV, true});
}

}  // namespace batten::internal
