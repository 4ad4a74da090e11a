// SPDX-License-Identifier: MIT
// Exact shapes as OpenCASCADE's analytic ones, and back. Not installed; includes OpenCASCADE.
#pragma once

#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <TopoDS_Shape.hxx>
#include <optional>

#include "batten/geometry/exact_shape.h"
#include "io/opencascade/parameter_rectangle.h"

namespace batten::internal {

// The edge on a line or circle, and the face on a plane, cylinder, cone, sphere or torus, with the
// shape's direction and normal. A cone that narrows along its axis lies on the cone about the
// opposite axis, u and v reversed. None where no valid face can be built, as of shapes smaller than
// OpenCASCADE's tolerance of 1e-7, and where its reader does not give the face back as it was: for
// tori that meet their axis or whose whole tube does not begin at angle 0, and for cones with their
// tip farther than 1e4 radii from the origin.
std::optional<TopoDS_Shape> ToAnalyticShape(const ExactCurve& shape);
std::optional<TopoDS_Shape> ToAnalyticShape(const ExactSurface& shape);

// The part of an analytic curve or surface within parameters, as ToNurbs makes it; none for other
// kinds, for left-handed ones and for parts of cones on both sides of the tip.
// Those that are said to be closed go all round.
std::optional<ExactCurve> FromAnalytic(const Handle(Geom_Curve) & curve,
                                       double first,
                                       double last,
                                       bool closed);
std::optional<ExactSurface> FromAnalytic(const Handle(Geom_Surface) & surface,
                                         const ParameterRectangle& box,
                                         const Seams& seams);

}  // namespace batten::internal
