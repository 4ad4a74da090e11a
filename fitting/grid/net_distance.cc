// SPDX-License-Identifier: MIT
#include "fitting/grid/net_distance.h"

#include <stdexcept>
#include <utility>
#include <vector>

#include "batten/geometry/insert_knots.h"
#include "batten/geometry/knot_vectors.h"
#include "geometry/nurbs/homogeneous.h"

namespace batten::internal {
namespace {

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
  NurbsSurface first = a, second = b;
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    for (auto [one, other] : {std::pair(&first, &second), std::pair(&second, &first)})
      *one = RefineKnots(
          *one, direction, MissingKnots(BasisOf(*one, direction), BasisOf(*other, direction)));
    const std::vector<double> more = Cuts(BasisOf(first, direction), cuts);
    if (more.empty()) continue;  // saves copies
    first = RefineKnots(first, direction, more);
    second = RefineKnots(second, direction, more);
  }
  if (first.size_u() != second.size_u() || first.size_v() != second.size_v())
    throw std::invalid_argument("NetDistance: the surfaces have other degrees or domains");
  return (first.control_points() - second.control_points()).colwise().norm().maxCoeff();
}

}  // namespace batten::internal
