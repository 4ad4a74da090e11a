// SPDX-License-Identifier: MIT
// Exact lines, arcs, ellipses, planes, cylinders, cones, spheres, tori and surfaces of revolution.
#include <pybind11/stl.h>

#include <optional>

#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/body.h"

namespace batten::python {
namespace {

using Pair = std::pair<double, double>;

// Three numbers each, as the package has made sure: origin, axis and, or none, x.
Frame FrameOf(const Doubles& origin, const Doubles& axis, const std::optional<Doubles>& x) {
  const Eigen::Vector3d o = Vector(origin), z = Vector(axis);
  return x ? Frame(o, z, Eigen::Vector3d(Vector(*x))) : Frame(o, z);
}

AngleRange Angles(const Pair& range) { return {range.first, range.second}; }
Interval Range(const Pair& range) { return {range.first, range.second}; }

using X = std::optional<Doubles>;

}  // namespace

void BindMaking(py::module_& m) {
  m.def("line", [](const Doubles& start, const Doubles& end) {
    if (start.size() == 2)
      return MakeBody(MakeLine<2>(Eigen::Vector2d(Vector(start)), Eigen::Vector2d(Vector(end))));
    return MakeBody(MakeLine<3>(Eigen::Vector3d(Vector(start)), Eigen::Vector3d(Vector(end))));
  });
  m.def("arc",
        [](const Doubles& o, const Doubles& axis, const X& x, double radius, const Pair& angles) {
          if (o.size() == 2)
            return MakeBody(MakeArc(Eigen::Vector2d(Vector(o)), radius, Angles(angles)));
          return MakeBody(MakeArc(FrameOf(o, axis, x), radius, Angles(angles)));
        });
  m.def(
      "ellipse",
      [](const Doubles& o, const Doubles& axis, const X& x, const Pair& radii, const Pair& angles) {
        return MakeBody(
            MakeEllipseArc(FrameOf(o, axis, x), radii.first, radii.second, Angles(angles)));
      });
  m.def("bilinear",
        [](const Doubles& p00, const Doubles& p10, const Doubles& p01, const Doubles& p11) {
          return MakeBody(MakeBilinear(Vector(p00), Vector(p10), Vector(p01), Vector(p11)));
        });
  m.def("plane",
        [](const Doubles& o, const Doubles& axis, const X& x, const Pair& i, const Pair& j) {
          return MakeBody(MakePlane(FrameOf(o, axis, x), Range(i), Range(j)));
        });
  m.def("cylinder",
        [](const Doubles& o,
           const Doubles& axis,
           const X& x,
           double radius,
           const Pair& height,
           const Pair& angles) {
          return MakeBody(MakeCylinder(FrameOf(o, axis, x), radius, Range(height), Angles(angles)));
        });
  m.def("cone",
        [](const Doubles& o,
           const Doubles& axis,
           const X& x,
           const Pair& radii,
           const Pair& height,
           const Pair& angles) {
          return MakeBody(MakeCone(
              FrameOf(o, axis, x), radii.first, radii.second, Range(height), Angles(angles)));
        });
  m.def("sphere",
        [](const Doubles& o,
           const Doubles& axis,
           const X& x,
           double radius,
           const Pair& longitude,
           const Pair& latitude) {
          return MakeBody(
              MakeSphere(FrameOf(o, axis, x), radius, Angles(longitude), Range(latitude)));
        });
  m.def("torus",
        [](const Doubles& o,
           const Doubles& axis,
           const X& x,
           const Pair& radii,
           const Pair& round,
           const Pair& tube) {
          return MakeBody(MakeTorus(
              FrameOf(o, axis, x), radii.first, radii.second, Angles(round), Angles(tube)));
        });
  m.def("revolve",
        [](const Body& profile, const Doubles& o, const Doubles& axis, const Pair& angles) {
          const auto* curve = std::get_if<NurbsCurve<3>>(&profile.geometry());
          if (!curve) throw py::value_error("profile: a curve in space is needed");
          return MakeBody(Revolve(*curve, FrameOf(o, axis, std::nullopt), Angles(angles)));
        });
}

}  // namespace batten::python
