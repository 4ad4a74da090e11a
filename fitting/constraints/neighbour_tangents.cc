// SPDX-License-Identifier: MIT
#include "fitting/constraints/neighbour_tangents.h"

#include <vector>

#include "batten/geometry/clamp.h"
#include "batten/geometry/reverse.h"
#include "fitting/constraints/polynomial_curve.h"
#include "fitting/core/rounding.h"
#include "geometry/bezier/cubic_chain.h"
#include "geometry/nurbs/span_breaks.h"

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
  const std::vector<double> breaks = BreaksIn(surface.basis_u(), kParts);
  CubicChain<3> chain;
  for (size_t i = 1; i < breaks.size(); ++i) {
    const double a = breaks[i - 1], b = breaks[i];
    // The slope at the end is that from below.
    const SurfaceJet start = surface.JetAt(a, v),
                     end = surface.JetAt(b - kRelativelyEqual * (b - a), v);
    Eigen::Matrix<double, 3, 4> cubic;
    cubic << start.dv, start.dv + (b - a) / 3 * start.duv, end.dv - (b - a) / 3 * end.duv,
        surface.JetAt(b, v).dv;
    chain.Add(cubic, a, b, 3);
  }
  return chain.Take();
}

// The derivative at the top of a non-rational surface clamped there.
NurbsCurve<3> ExactDerivative(const NurbsSurface& surface) {
  const SplineBasis &along = surface.basis_u(), &across = surface.basis_v();
  const int p = across.degree(), n = across.size();
  const double slope = p / (across.knots()[n - 1 + p] - across.knots()[n - 1]);
  Eigen::Matrix3Xd field(3, along.size());
  for (int k = 0; k < along.size(); ++k)
    field.col(k) = surface.control_point(k, n - 1) - surface.control_point(k, n - 2);
  return NurbsCurve<3>(along, slope * field);
}

}  // namespace

NurbsCurve<3> OutwardDerivative(const NeighbourEdge& edge) {
  const NurbsSurface surface = WithEdgeOnTop(edge);
  return surface.rational() ? SampledDerivative(surface) : ExactDerivative(surface);
}

}  // namespace batten::internal
