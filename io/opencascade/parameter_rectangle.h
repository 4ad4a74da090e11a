// SPDX-License-Identifier: MIT
// Faces that are a rectangle of their surface's parameters. Not installed; includes OpenCASCADE.
#pragma once

#include <Geom_Surface.hxx>
#include <TopoDS_Face.hxx>
#include <optional>

namespace batten::internal {

// The parameters u0 ≤ u ≤ u1, v0 ≤ v ≤ v1.
struct ParameterRectangle {
  double u0, u1, v0, v1;
  bool operator==(const ParameterRectangle&) const = default;
};

// The domain of a surface; infinite for a plane.
ParameterRectangle NaturalRectangle(const Geom_Surface& surface);

// The rectangle that a face fills; none when it is trimmed by anything else or has holes. Sides
// within 1e-7 of the natural ones, relative to the rectangle, are taken to be those.
std::optional<ParameterRectangle> RectangleOf(const TopoDS_Face& face);

// The directions in which a face closes: those across an edge that bounds it on both sides.
struct Seams {
  bool u = false, v = false;
};
Seams SeamsOf(const TopoDS_Face& face);

}  // namespace batten::internal
