// SPDX-License-Identifier: MIT
// Which curves are lines or conics, which surfaces are planes, cylinders, spheres, cones or tori.
#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// Lengths in the data's units, angles in radians, directions of length one; shapes of the plane lie
// at z = 0. An arc or patch is the shape that it is part of.

struct FreeForm {};

struct LineShape {
  Eigen::Vector3d point, direction;  // the curve's start, and where it leads
};

struct CircleShape {
  Eigen::Vector3d center, normal;
  double radius;
};

struct EllipseShape {
  Eigen::Vector3d center, major_axis, minor_axis;
  double major_radius, minor_radius;
};

struct ParabolaShape {
  Eigen::Vector3d vertex, axis;  // the axis points into the parabola
  Eigen::Vector3d normal;
  double focal_length;  // the focus is vertex + focal_length · axis
};

struct HyperbolaShape {
  Eigen::Vector3d center, transverse_axis, conjugate_axis;  // the first points to the branch
  double transverse_radius, conjugate_radius;
};

struct PlaneShape {
  Eigen::Vector3d point, normal;
};

struct CylinderShape {
  Eigen::Vector3d point, axis;  // the point lies on the axis
  double radius;
};

struct SphereShape {
  Eigen::Vector3d center;
  double radius;
};

struct ConeShape {
  Eigen::Vector3d apex, axis;  // the axis points into the cone
  double half_angle;
};

// A spindle where minor_radius > major_radius.
struct TorusShape {
  Eigen::Vector3d center, axis;
  double major_radius, minor_radius;
};

// Any other surface that turns into itself about an axis.
struct RevolutionShape {
  Eigen::Vector3d point, axis;
};

// Any other surface that slides along itself: a general cylinder.
struct ExtrusionShape {
  Eigen::Vector3d direction;
};

using CurveShape =
    std::variant<FreeForm, LineShape, CircleShape, EllipseShape, ParabolaShape, HyperbolaShape>;
using SurfaceShape = std::variant<FreeForm,
                                  PlaneShape,
                                  CylinderShape,
                                  SphereShape,
                                  ConeShape,
                                  TorusShape,
                                  RevolutionShape,
                                  ExtrusionShape>;

// "free", "line", "circle", …, "plane", …, "revolution", "extrusion".
std::string NameOf(const CurveShape& shape);
std::string NameOf(const SurfaceShape& shape);

struct ClassifyOptions {
  // How far the shape may be away, relative to the diagonal of the box of the sampled points; > 0.
  // Never less than eight units in the last place of the largest coordinate: closer, control points
  // can't be stored.
  double tolerance = 1e-9;
};

// The first of line, circle, parabola, ellipse and hyperbola that the whole curve lies on within
// the tolerance. Degree, knots, weights and speed do not matter. The candidate is the least-squares
// fit to samples; it counts only if denser ones, dense enough that the implicit form is bounded
// between them too (SteadySections), lie within the tolerance. A flat arc that both a line and a
// circle come near enough is the line, and so on. Free are: anything else, a curve collapsed to a
// point, and a hyperbola that is within the tolerance of its asymptotes: two lines. Throws
// std::invalid_argument unless the tolerance is positive. O(control points · degree).
template <int Dim>
CurveShape ClassifyShape(const NurbsCurve<Dim>& curve, const ClassifyOptions& options = {});

// The first of plane, sphere, cylinder, cone, torus, revolution and extrusion, in the same way;
// free: anything else, and a surface collapsed to a curve or point. For the last two every normal
// must be perpendicular to the motion, so that a turn by one radian or a shift by the size moves
// the surface off itself by the tolerance at most. [Lukács, Martin & Marshall 1998; axes: Pottmann
// & Randrup 1998]
SurfaceShape ClassifyShape(const NurbsSurface& surface, const ClassifyOptions& options = {});

extern template CurveShape ClassifyShape(const NurbsCurve<2>&, const ClassifyOptions&);
extern template CurveShape ClassifyShape(const NurbsCurve<3>&, const ClassifyOptions&);

// The conic shape factor k = w0·w2 / w1² of a quadratic rational Bézier curve, the same for every
// linear rational reparameterization. [Piegl & Tiller 1997, §7.3]
double ConicShapeFactor(double w0, double w1, double w2);

enum class ConicKind { kEllipse, kParabola, kHyperbola };

// What a quadratic rational Bézier curve is when its control points are not on one line: an ellipse
// for k > 1, a parabola for k = 1, a hyperbola for k < 1, with |k − 1| ≤ tolerance taken for one.
// The sign of w1 chooses the arc, not the kind. Throws std::invalid_argument unless w0·w2 > 0,
// w1 ≠ 0 (the chord), all are finite and tolerance ≥ 0. [Piegl & Tiller 1997, §7.3]
ConicKind ClassifyConic(double w0, double w1, double w2, double tolerance = 1e-12);

}  // namespace batten
