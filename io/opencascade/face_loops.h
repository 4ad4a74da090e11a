// SPDX-License-Identifier: MIT
// The boundary of a face of OpenCASCADE as loops. Not installed; includes OpenCASCADE.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "io/exchange/parameter_map.h"
#include "io/opencascade/parameter_rectangle.h"

namespace batten::internal {

// For every wire, in their order, the curves of its edges in the surface's parameters, each
// following the one before it; over directions with a period moved by whole periods to that end,
// and all into one period from the least of the first wire's on. Where their speed is kept, at
// which they are one point with the edge, circles and their like are cubics within 1e-7 of their
// size. Throws std::invalid_argument for an edge without such a curve.
std::vector<std::vector<NurbsCurve<2>>> WiresOf(const TopoDS_Face& face,
                                                CurveSpeed speed = CurveSpeed::kAny);

// The edges of the same wires, in the same order.
std::vector<std::vector<TopoDS_Edge>> EdgesOfWires(const TopoDS_Face& face);

// The box of the curves.
ParameterRectangle BoxOf(const std::vector<std::vector<NurbsCurve<2>>>& wires);

}  // namespace batten::internal
