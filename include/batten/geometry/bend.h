// SPDX-License-Identifier: MIT
// Shapes bent about a circle.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// A bend of space about a circle's axis. The line through `from` perpendicular to its distance from
// the axis, in the direction in which the circle runs (right-handed about the axis), is wound onto
// the circle through `from` over `length`: the point at x along that line, x in [0, length], h
// above it and z along the axis goes to the angle x/radius, radius + h from the axis, at the same
// z. What lies before stays, and what lies behind turns along as it is. Arc lengths at h = 0 stay.
struct CircleBend {
  Eigen::Vector3d from = Eigen::Vector3d::UnitX(), center = Eigen::Vector3d::Zero(),
                  axis = Eigen::Vector3d::UnitZ();
  double length = 1;  // in the data's units, > 0, at most once round the circle
};

template <typename Shape>
struct BentShape {
  Shape shape;
  double error;  // of the samples, how far the farthest is from the image of the old shape's point
};

// The shape bent, each point to within the tolerance (data's units, > 0) of the image of the old
// one at its parameter, as far as 9 samples a span (a cell) tell. Control points go to their images
// and from there to where the shape meets the images at its Greville abscissae; knots are inserted
// where that is not enough, in the directions in which no piece over the old spans comes near
// enough, up to 2000 control points a direction and 200 000 in all; then the error says what is
// left. Images break at both ends of the bend, but for what lies at the radius: a curve gets knots
// of full multiplicity there, a surface where one of its parameter lines lies there. A plane curve
// lies at z = 0, and its bend has an axis along z. Throws std::invalid_argument where lengths are
// not positive or not finite, `from` lies on the axis, the bend goes more than once round, or the
// shape reaches the axis within it. [after Piegl & Tiller 1997, §11.4.3; Barr 1984, "Global and
// local deformations of solid primitives"; Lin, Wang & Dong 2004, progressive iteration]
template <int Dim>
BentShape<NurbsCurve<Dim>> Bent(const NurbsCurve<Dim>& curve,
                                const CircleBend& bend,
                                double tolerance);
BentShape<NurbsSurface> Bent(const NurbsSurface& surface, const CircleBend& bend, double tolerance);

}  // namespace batten
