// SPDX-License-Identifier: MIT
// Curves on surfaces as curves in space. Not installed; includes OpenCASCADE.
#pragma once

#include <Geom2d_BSplineCurve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>

namespace batten::internal {

// The spline that follows the surface along a curve in its parameters, with the same parameter,
// within 1e-9 of the size of the surface's control points where OpenCASCADE reaches that. Throws
// Standard_Failure where it finds none.
Handle(Geom_BSplineCurve) CurveInSpace(const Handle(Geom_BSplineSurface) & surface,
                                       const Handle(Geom2d_BSplineCurve) & parameters);

// How far the two are apart, at 23 places of every span of the curve in parameters.
double Deviation(const Geom_Curve& in_space,
                 const Geom2d_BSplineCurve& parameters,
                 const Geom_Surface& surface);

}  // namespace batten::internal
