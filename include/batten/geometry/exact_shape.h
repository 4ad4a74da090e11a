// SPDX-License-Identifier: MIT
// Exact shapes with their extents, and which NURBS are such a shape as it is made here.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <variant>

#include "batten/geometry/frame.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// What the functions of make_curve.h and make_surface.h take.

struct ExactLine {
  Eigen::Vector3d start, end;
};

struct ExactArc {
  Frame frame;
  double radius;
  AngleRange angles;
};

struct ExactPlane {
  Frame frame;
  Interval x, y;
};

struct ExactCylinder {
  Frame frame;
  double radius;
  Interval height;
  AngleRange angles;
};

struct ExactCone {
  Frame frame;
  double radius_lower, radius_upper;
  Interval height;
  AngleRange angles;
};

struct ExactSphere {
  Frame frame;
  double radius;
  AngleRange longitude;
  Interval latitude;
};

struct ExactTorus {
  Frame frame;
  double major, minor;
  AngleRange round, tube;
};

using ExactCurve = std::variant<ExactLine, ExactArc>;
using ExactSurface = std::variant<ExactPlane, ExactCylinder, ExactCone, ExactSphere, ExactTorus>;

// As the function of its kind makes it.
NurbsCurve<3> ToNurbs(const ExactCurve& shape);
NurbsSurface ToNurbs(const ExactSurface& shape);

// The shape of which `ToNurbs` gives this curve or surface again: the same degrees, knots and, to
// 1e-13 of the size and eight units in the last place of the largest coordinate, control points and
// weights. None for all else, also where the same set of points is parameterized in another way:
// such a shape would not come back as it was. Angles round the axis start at 0; heights at 0; a
// plane's x and y at 0. O(1).
std::optional<ExactCurve> ExactShapeOf(const NurbsCurve<3>& curve);
std::optional<ExactSurface> ExactShapeOf(const NurbsSurface& surface);

}  // namespace batten
