// SPDX-License-Identifier: MIT
#include "batten/geometry/compatible_curves.h"

#include <algorithm>
#include <utility>

#include "batten/geometry/clamp.h"
#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/reparameterize.h"
#include "geometry/construction/compatible_knots.h"
#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

bool AllPeriodicAlike(const std::vector<NurbsCurve<3>>& curves) {
  return std::ranges::all_of(curves, [&](const NurbsCurve<3>& curve) {
    return curve.basis().periodic() && curve.basis() == curves.front().basis();
  });
}

}  // namespace

std::vector<NurbsCurve<3>> Compatible(std::vector<NurbsCurve<3>> curves) {
  RequireThat(!curves.empty(), "Compatible", "there are no curves");
  int degree = 1;
  for (NurbsCurve<3>& curve : curves) {
    curve = Reparameterized(curve, 0, 1);
    degree = std::max(degree, curve.basis().degree());
  }
  for (NurbsCurve<3>& curve : curves) curve = Elevated(curve, degree - curve.basis().degree());
  if (AllPeriodicAlike(curves)) return curves;
  for (NurbsCurve<3>& curve : curves) curve = Clamped(curve);
  std::vector<SplineBasis> bases;
  for (const NurbsCurve<3>& curve : curves) bases.push_back(curve.basis());
  bases = Snapped(std::move(bases));
  const SplineBasis common = CommonBasis(bases);
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const NurbsCurve<3> snapped(bases[k], curves[k].control_points(), curves[k].weights());
    curves[k] = RefineKnots(snapped, MissingKnots(bases[k], common));
  }
  return curves;
}

}  // namespace batten
