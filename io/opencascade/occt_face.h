// SPDX-License-Identifier: MIT
// A face of OpenCASCADE as a surface, trimmed where it is. Not installed; includes OpenCASCADE.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// The wires of a face (EdgesOfWires) as curves in the parameters of its surface; none where they
// can't be brought there.
struct FaceWires {
  std::vector<std::vector<NurbsCurve<2>>> curves = {};
  bool turned = false;  // the surface's normal is opposite to that of the face's own surface
};

struct FaceShape {
  NurbsSurface surface;
  FaceWires wires;
};

// A face that fills a rectangle of an analytic surface, or all of a B-spline one, comes untrimmed;
// any other with a loop for every wire, over the B-spline as it stands or over the box of its
// boundary on other surfaces; those whose parameters are not those of a NURBS form (swept ones,
// offsets) are turned into one by OpenCASCADE. Throws std::invalid_argument naming the wire whose
// edges do not follow one another to 1e-3 of the domain, or, up to 0.05 of it, to the tolerance of
// their corners, and where batten's constructors do; Standard_Failure where OpenCASCADE does.
FaceShape FaceToNurbs(const TopoDS_Face& face);

}  // namespace batten::internal
