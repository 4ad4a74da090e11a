// SPDX-License-Identifier: MIT
#include "batten/geometry/degree_elevation.h"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/editing/control_rows.h"
#include "geometry/editing/knot_groups.h"
#include "geometry/editing/polar_form.h"

namespace batten {
using namespace internal;
namespace {

void CheckElevation(int degree, int by) {
  if (by < 0) {
    throw std::invalid_argument("Elevated: by = " + std::to_string(by) + " is negative");
  }
  if (by > kMaxDegree - degree) {
    throw std::invalid_argument("Elevated: degree " + std::to_string(degree) + " raised by " +
                                std::to_string(by) + " is above " + std::to_string(kMaxDegree));
  }
}

ControlRows ElevatedRows(ControlRows rows, int by) {
  const int p = rows.basis.degree();
  KnotGroups groups = GroupKnots(rows.basis);
  rows.basis = BasisOfGroups(groups, p);
  for (int q = p + 1; q <= p + by; ++q) {
    groups = RaisedMultiplicities(std::move(groups));
    SplineBasis next = BasisOfGroups(groups, q);
    const std::vector<ControlMean> means = ElevationMeans(rows.basis, next);
    rows = Combined(means, rows, std::move(next));
  }
  return rows;
}

}  // namespace

template <int Dim>
NurbsCurve<Dim> Elevated(const NurbsCurve<Dim>& curve, int by) {
  CheckElevation(curve.basis().degree(), by);
  if (by == 0) return curve;
  return CurveOf<Dim>(ElevatedRows(RowsOf(curve), by));
}

template NurbsCurve<2> Elevated(const NurbsCurve<2>&, int);
template NurbsCurve<3> Elevated(const NurbsCurve<3>&, int);

NurbsSurface Elevated(const NurbsSurface& surface, Direction direction, int by) {
  const ControlRows rows = RowsOf(surface, direction);
  CheckElevation(rows.basis.degree(), by);
  if (by == 0) return surface;
  return SurfaceOf(ElevatedRows(rows, by), direction, OtherBasis(surface, direction))
      .WithTrims(surface.trims());
}

}  // namespace batten
