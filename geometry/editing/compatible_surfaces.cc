// SPDX-License-Identifier: MIT
#include "geometry/editing/compatible_surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "batten/geometry/clamp.h"
#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/knot_vectors.h"
#include "geometry/editing/control_rows.h"

namespace batten::internal {
namespace {

// The basis with inner knots that are nearly knots of `other` moved there.
SplineBasis Snapped(const SplineBasis& basis, const SplineBasis& other) {
  constexpr double kSame = 1e-12;
  const double largest = std::max(std::abs(basis.lower()), std::abs(basis.upper()));
  const double near = std::max(kSame * (basis.upper() - basis.lower()),
                               4 * std::numeric_limits<double>::epsilon() * largest);
  std::vector<double> knots = basis.knots();
  const std::vector<KnotMultiplicity> places = DomainKnots(other);
  for (double& knot : knots) {
    if (knot <= basis.lower() || knot >= basis.upper()) continue;
    for (const KnotMultiplicity& place : places) {
      const bool inner = place.knot > basis.lower() && place.knot < basis.upper();
      if (inner && std::abs(place.knot - knot) <= near) knot = place.knot;
    }
  }
  return SplineBasis(basis.degree(), std::move(knots));
}

NurbsSurface WithBasis(const NurbsSurface& surface, Direction direction, SplineBasis basis) {
  ControlRows rows = RowsOf(surface, direction);
  rows.basis = std::move(basis);
  return SurfaceOf(rows, direction, OtherBasis(surface, direction));
}

}  // namespace

void RaiseToSameDegree(NurbsSurface& a, NurbsSurface& b, Direction direction) {
  const auto degree = [&](const NurbsSurface& surface) {
    return direction == Direction::kU ? surface.basis_u().degree() : surface.basis_v().degree();
  };
  const int by = degree(b) - degree(a);
  if (by > 0) a = Elevated(a, direction, by);
  if (by < 0) b = Elevated(b, direction, -by);
}

void PutOverSameKnots(NurbsSurface& a, NurbsSurface& b, Direction direction) {
  const auto basis = [direction](const NurbsSurface& surface) -> const SplineBasis& {
    return direction == Direction::kU ? surface.basis_u() : surface.basis_v();
  };
  const double lower = basis(a).lower(), upper = basis(a).upper();
  if (basis(b).lower() != lower || basis(b).upper() != upper) {
    b = WithBasis(b, direction, Scaled(basis(b), lower, upper));
  }
  if (basis(a) == basis(b)) return;
  a = Clamped(a, direction);
  b = Clamped(b, direction);
  b = WithBasis(b, direction, Snapped(basis(b), basis(a)));
  a = RefineKnots(a, direction, MissingKnots(basis(a), basis(b)));
  b = RefineKnots(b, direction, MissingKnots(basis(b), basis(a)));
}

}  // namespace batten::internal
