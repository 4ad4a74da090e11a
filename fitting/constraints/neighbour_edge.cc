// SPDX-License-Identifier: MIT
#include "fitting/constraints/neighbour_edge.h"

#include <stdexcept>
#include <string>

#include "batten/geometry/clamp.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"

namespace batten::internal {
namespace {

NurbsCurve<3> EdgeCurve(const NurbsSurface& surface, const SurfaceEdge& edge) {
  const SplineBasis& across =
      edge.direction == Direction::kU ? surface.basis_u() : surface.basis_v();
  return IsoCurve(surface, edge.direction, edge.upper ? across.upper() : across.lower());
}

}  // namespace

NurbsCurve<3> CrossDerivative(const NurbsSurface& surface, const SurfaceEdge& edge) {
  const auto reject = [](const char* rule) {
    throw std::invalid_argument(std::string("CrossDerivative: ") + rule);
  };
  if (surface.rational()) reject("the surface must have no weights");
  const bool across_u = edge.direction == Direction::kU;
  if ((across_u ? surface.basis_u() : surface.basis_v()).periodic())
    reject("the surface is closed across the edge: it has none");
  const NurbsSurface open = Clamped(surface, edge.direction);
  const SplineBasis& across = across_u ? open.basis_u() : open.basis_v();
  const SplineBasis& along = across_u ? open.basis_v() : open.basis_u();
  const int p = across.degree(), n = across.size(), first = edge.upper ? n - 2 : 0;
  const double slope = p / (across.knots()[first + 1 + p] - across.knots()[first + 1]);
  Eigen::Matrix3Xd field(3, along.size());
  for (int k = 0; k < along.size(); ++k) {
    field.col(k) = across_u ? open.control_point(first + 1, k) - open.control_point(first, k)
                            : open.control_point(k, first + 1) - open.control_point(k, first);
  }
  return NurbsCurve<3>(along, slope * field);
}

FixedEdge EdgeOfNeighbour(const NurbsSurface& neighbour,
                          const SurfaceEdge& theirs,
                          const SurfaceEdge& own,
                          const SplineBasis& along,
                          bool reversed,
                          bool tangent) {
  const auto placed = [&](const NurbsCurve<3>& curve) {
    return Reparameterized(reversed ? Reversed(curve) : curve, along.lower(), along.upper());
  };
  FixedEdge edge{own, placed(EdgeCurve(neighbour, theirs))};
  if (!tangent) return edge;
  const NurbsCurve<3> field = CrossDerivative(neighbour, theirs);
  // Out of the neighbour, into the surface.
  const double sign = theirs.upper == own.upper ? -1 : 1;
  edge.across = placed(NurbsCurve<3>(field.basis(), sign * field.control_points()));
  return edge;
}

}  // namespace batten::internal
