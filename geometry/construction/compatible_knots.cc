// SPDX-License-Identifier: MIT
#include "geometry/construction/compatible_knots.h"

#include <algorithm>
#include <utility>

#include "batten/geometry/clamp.h"
#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/knot_vectors.h"
#include "geometry/editing/control_rows.h"
#include "geometry/nurbs/homogeneous.h"

namespace batten::internal {
namespace {

constexpr double kSameKnot = 1e-12;

bool IsInner(double knot) { return knot > 0 && knot < 1; }

NurbsSurface OverBasis(const NurbsSurface& surface, Direction direction, const SplineBasis& basis) {
  return Edited(surface, direction, [&](ControlRows rows) {
    rows.basis = basis;
    return rows;
  });
}

void BringTogether(std::vector<NurbsSurface>& surfaces, Direction direction) {
  int degree = 1;
  for (const NurbsSurface& surface : surfaces) {
    degree = std::max(degree, BasisOf(surface, direction).degree());
  }
  std::vector<SplineBasis> bases;
  for (NurbsSurface& surface : surfaces) {
    surface = Clamped(surface, direction);
    surface = Elevated(surface, direction, degree - BasisOf(surface, direction).degree());
    bases.push_back(BasisOf(surface, direction));
  }
  bases = Snapped(std::move(bases));
  const SplineBasis common = CommonBasis(bases);
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    if (bases[k] != BasisOf(surfaces[k], direction)) {
      surfaces[k] = OverBasis(surfaces[k], direction, bases[k]);
    }
    surfaces[k] = RefineKnots(surfaces[k], direction, MissingKnots(bases[k], common));
  }
}

}  // namespace

std::vector<SplineBasis> Snapped(std::vector<SplineBasis> bases) {
  std::vector<double> all, places;
  for (const SplineBasis& basis : bases) {
    std::ranges::copy_if(basis.knots(), std::back_inserter(all), IsInner);
  }
  std::ranges::sort(all);
  for (const double knot : all) {
    if (places.empty() || knot - places.back() > kSameKnot) places.push_back(knot);
  }
  for (SplineBasis& basis : bases) {
    std::vector<double> knots = basis.knots();
    for (double& knot : knots) {
      if (IsInner(knot)) knot = *(std::ranges::upper_bound(places, knot) - 1);
    }
    basis = SplineBasis(basis.degree(), std::move(knots));
  }
  return bases;
}

SplineBasis CommonBasis(const std::vector<SplineBasis>& bases) {
  SplineBasis common = bases.front();
  for (const SplineBasis& basis : bases) {
    std::vector<double> knots = common.knots();
    const std::vector<double> missing = MissingKnots(common, basis);
    if (missing.empty()) continue;
    knots.insert(knots.end(), missing.begin(), missing.end());
    std::ranges::sort(knots);
    common = SplineBasis(common.degree(), std::move(knots));
  }
  return common;
}

std::vector<NurbsSurface> Compatible(std::vector<NurbsSurface> surfaces) {
  BringTogether(surfaces, Direction::kU);
  BringTogether(surfaces, Direction::kV);
  return surfaces;
}

}  // namespace batten::internal
