// SPDX-License-Identifier: MIT
// Curves and surfaces of entries of the exchange form. Not installed.
#pragma once

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "io/base/json_field.h"

namespace batten::internal {

// The curve or surface of an entry, its trims aside, as geometry_json.h says. Throws ReadError
// naming the field, std::invalid_argument where batten's constructors do.
template <int Dim>
NurbsCurve<Dim> ReadJsonCurve(const JsonField& entry);
NurbsSurface ReadJsonSurface(const JsonField& entry);

// Its member `points`, of two numbers each.
Eigen::Matrix2Xd ReadJsonPoints(const JsonField& entry);

}  // namespace batten::internal
