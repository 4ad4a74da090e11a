// SPDX-License-Identifier: MIT
// Curves in other places.
#pragma once

#include "batten/geometry/nurbs_curve.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {

// The curve moved by a vector.
template <int Dim>
NurbsCurve<Dim> Translated(const NurbsCurve<Dim>& curve,
                           const typename NurbsCurve<Dim>::Point& by) {
  return NurbsCurve<Dim>(curve.basis(), curve.control_points().colwise() + by, curve.weights());
}

// The curve in space; a plane one at z = 0.
template <int Dim>
NurbsCurve<3> InSpace(const NurbsCurve<Dim>& curve) {
  return NurbsCurve<3>(curve.basis(), PointsInSpace(curve.control_points()), curve.weights());
}

}  // namespace batten::internal
