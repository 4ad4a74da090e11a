// SPDX-License-Identifier: MIT
#include "fitting/grid/net_distance.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "batten/geometry/insert_knots.h"
#include "batten/geometry/knot_vectors.h"
#include "fitting/core/rounding.h"

namespace batten::internal {
namespace {

const SplineBasis& BasisOf(const NurbsSurface& surface, Direction direction) {
  return direction == Direction::kU ? surface.basis_u() : surface.basis_v();
}

NurbsSurface WithKnotsOf(const NurbsSurface& surface,
                         const NurbsSurface& other,
                         Direction direction) {
  const std::vector<double> missing =
      MissingKnots(BasisOf(surface, direction), BasisOf(other, direction));
  return missing.empty() ? surface : RefineKnots(surface, direction, missing);
}

std::vector<double> Cuts(const SplineBasis& basis, int cuts) {
  std::vector<double> knots;
  for (const int span : basis.Spans()) {
    const double low = basis.knots()[static_cast<size_t>(span)],
                 high = basis.knots()[static_cast<size_t>(span) + 1];
    for (int k = 1; k < cuts; ++k) {
      const double knot = low + (high - low) * k / cuts;
      if (knot > (knots.empty() ? low : knots.back()) && knot > low && knot < high) {
        knots.push_back(knot);
      }
    }
  }
  return knots;
}

}  // namespace

double NetDistance(const NurbsSurface& a, const NurbsSurface& b, int cuts) {
  if (a.rational() || b.rational()) {
    throw std::invalid_argument("NetDistance: the surfaces must not be rational");
  }
  NurbsSurface first = a, second = b;
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    first = WithKnotsOf(first, second, direction);
    second = WithKnotsOf(second, first, direction);
    const std::vector<double> more = Cuts(BasisOf(first, direction), cuts);
    if (more.empty()) continue;
    first = RefineKnots(first, direction, more);
    second = RefineKnots(second, direction, more);
  }
  // Knots repeated by a period carry rounding errors.
  const auto same = [](const SplineBasis& x, const SplineBasis& y) {
    return SameKnots(x, y, kRelativeRounding * std::max(std::abs(x.lower()), std::abs(x.upper())));
  };
  if (!same(first.basis_u(), second.basis_u()) || !same(first.basis_v(), second.basis_v())) {
    throw std::invalid_argument("NetDistance: the surfaces have other degrees or domains");
  }
  return (first.control_points() - second.control_points()).colwise().norm().maxCoeff();
}

}  // namespace batten::internal
