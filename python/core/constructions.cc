// SPDX-License-Identifier: MIT
// Surfaces made of curves: extruded, ruled, lofted, swept, swung, Gordon, Coons, bicubic patches.
#include <pybind11/stl.h>

#include <optional>

#include "batten/geometry/aligned_curves.h"
#include "batten/geometry/bicubic_patch.h"
#include "batten/geometry/coons_surface.h"
#include "batten/geometry/gordon_surface.h"
#include "batten/geometry/lofted_surface.h"
#include "batten/geometry/ruled_surface.h"
#include "batten/geometry/swept_surface.h"
#include "batten/geometry/swung_surface.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/body.h"

namespace batten::python {
namespace {

using Bodies = std::vector<BodyPtr>;
using End = std::optional<std::pair<Doubles, double>>;  // direction and fullness

NurbsCurve<3> CurveOf(const Body& body) {
  const auto* curve = std::get_if<NurbsCurve<3>>(&body.geometry());
  if (curve == nullptr) throw py::value_error("a curve in space is needed");
  return *curve;
}

std::vector<NurbsCurve<3>> CurvesOf(const Bodies& bodies) {
  std::vector<NurbsCurve<3>> curves;
  for (const BodyPtr& body : bodies) curves.push_back(CurveOf(*body));
  return curves;
}

// `make` without the interpreter's lock.
template <typename Make>
BodyPtr Made(const Make& make) {
  const py::gil_scoped_release released;
  return MakeBody(make());
}

std::optional<LoftEnd> EndOf(const End& end) {
  if (!end) return {};
  return LoftEnd{Eigen::Vector3d(Vector(end->first)), end->second};
}

std::array<Eigen::Vector3d, 4> Four(const Doubles& rows) {
  const Eigen::Matrix3Xd columns = Columns<3>(rows, "corners");
  return {columns.col(0), columns.col(1), columns.col(2), columns.col(3)};
}

}  // namespace

void BindConstructions(py::module_& m) {
  m.def("extrude", [](const Body& profile, const Doubles& by) {
    return MakeBody(Extrude(CurveOf(profile), Eigen::Vector3d(Vector(by))));
  });
  m.def("ruled", [](const Body& first, const Body& second, bool by_length, double tolerance) {
    const auto a = CurveOf(first), b = CurveOf(second);
    const RuledOptions options{by_length ? RuledBy::kLength : RuledBy::kParameter, tolerance};
    return Made([&] { return Ruled(a, b, options).surface; });
  });
  m.def("aligned",
        [](const Bodies& bodies) { return MakeBodies(Aligned(CurvesOf(bodies)).curves); });
  m.def("loft",
        [](const Bodies& bodies,
           int degree,
           bool closed,
           const End& start,
           const End& end,
           const BodyPtr& spine,
           bool align,
           double tolerance) {
          const auto sections = CurvesOf(bodies);
          LoftOptions options;
          options.degree = degree;
          options.closed = closed;
          options.start = EndOf(start);
          options.end = EndOf(end);
          if (spine) options.spine = CurveOf(*spine);
          options.align = align;
          options.tolerance = tolerance;
          return Made([&] { return Loft(sections, options).surface; });
        });
  m.def("sweep_translational", [](const Body& profile, const Body& trajectory) {
    return MakeBody(SweepTranslational(CurveOf(profile), CurveOf(trajectory)));
  });
  m.def("sweep", [](const Body& profile, const Body& trajectory, double tolerance, double twist) {
    const auto moved = CurveOf(profile), along = CurveOf(trajectory);
    return Made(
        [&] { return Sweep(moved, along, {.tolerance = tolerance, .twist = twist}).surface; });
  });
  m.def("swing",
        [](const Body& profile,
           const Body& trajectory,
           const Doubles& origin,
           const Doubles& axis,
           const std::optional<Doubles>& x,
           double scale) {
          const Eigen::Vector3d o = Vector(origin), z = Vector(axis);
          const Frame frame = x ? Frame(o, z, Eigen::Vector3d(Vector(*x))) : Frame(o, z);
          return MakeBody(Swing(CurveOf(profile), CurveOf(trajectory), frame, scale));
        });
  m.def("gordon", [](const Bodies& u, const Bodies& v, double tolerance) {
    const auto along_u = CurvesOf(u), along_v = CurvesOf(v);
    return Made([&] { return Gordon(along_u, along_v, {.tolerance = tolerance}).surface; });
  });
  m.def("coons", [](const Bodies& bodies, bool bicubic, double tolerance) {
    const auto sides = CurvesOf(bodies);
    return Made([&] { return Coons(sides, {.tolerance = tolerance, .bicubic = bicubic}).surface; });
  });
  m.def("patch",
        [](const Doubles& points, const Doubles& u, const Doubles& v, const Doubles& twists) {
          return MakeBody(BicubicPatch({Four(points), Four(u), Four(v), Four(twists)}));
        });
}

}  // namespace batten::python
