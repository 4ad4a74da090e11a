// SPDX-License-Identifier: MIT
// NURBS between batten and OpenCASCADE. Not installed; includes OpenCASCADE.
#pragma once

#include <Geom2d_BSplineCurve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TCollection_HAsciiString.hxx>
#include <string>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// Knots, control points and weights as they are. Throws Standard_Failure for what OpenCASCADE does
// not hold, such as distinct knots that differ by rounding only.
Handle(Geom_BSplineCurve) ToOcct(const NurbsCurve<3>& curve);
Handle(Geom_BSplineCurve) ToOcct(const NurbsCurve<2>& curve);  // at z = 0
Handle(Geom2d_BSplineCurve) ToOcct2d(const NurbsCurve<2>& curve);
Handle(Geom_BSplineSurface) ToOcct(const NurbsSurface& surface);  // without its trims

// The reverse, for shapes that are not periodic. Throws std::invalid_argument where batten's
// constructors do.
NurbsCurve<3> FromOcct(const Geom_BSplineCurve& curve);
NurbsCurve<2> FromOcct(const Geom2d_BSplineCurve& curve);
NurbsSurface FromOcct(const Geom_BSplineSurface& surface);

Handle(TCollection_HAsciiString) Text(const std::string& text);

}  // namespace batten::internal
