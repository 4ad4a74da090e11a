// SPDX-License-Identifier: MIT
// Where curves and surfaces meet, and offsets of both.
#include <pybind11/stl.h>

#include "batten/geometry/intersect_curves.h"
#include "batten/geometry/intersect_surfaces.h"
#include "batten/geometry/offset_curve.h"
#include "batten/geometry/offset_surface.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/body.h"
#include "python/core/watch.h"

namespace batten::python {
namespace {

using Region = std::array<std::array<double, 2>, 2>;

std::vector<double> Row(const Eigen::VectorXd& x) { return {x.data(), x.data() + x.size()}; }

// f(curve), of either dimension.
template <typename Function>
auto WithCurve(const Body& body, Function f) {
  if (const auto* plane = std::get_if<NurbsCurve<2>>(&body.geometry())) return f(*plane);
  return f(std::get<NurbsCurve<3>>(body.geometry()));
}

Region BoxOf(const ParameterBox& box) { return {{{box.u0, box.u1}, {box.v0, box.v1}}}; }

// (kind, closed, curve, on first, on second, deviation) of each branch; (point, first, second, on a
// branch) of each touch; (first, second, point) of each overlap; the tolerance.
py::tuple Surfaces(const BodyPtr& first,
                   const BodyPtr& second,
                   const std::optional<double>& tolerance) {
  first->surface();
  second->surface();
  SurfaceIntersection met = Watched([=](Watch&) {
    return IntersectSurfaces(first->surface(), second->surface(), {.tolerance = tolerance});
  });
  py::list branches, touches, overlaps;
  for (SurfaceBranch& branch : met.branches) {
    branches.append(py::make_tuple(NameOf(branch.kind),
                                   branch.closed,
                                   MakeBodies(std::vector{branch.curve}).front(),
                                   MakeBodies(branch.on_first),
                                   MakeBodies(branch.on_second),
                                   branch.deviation));
  }
  for (const SurfaceTouch& touch : met.touches) {
    touches.append(py::make_tuple(
        Row(touch.point), Row(touch.on_first), Row(touch.on_second), touch.on_branch));
  }
  for (const SurfaceOverlap& overlap : met.overlaps) {
    overlaps.append(
        py::make_tuple(BoxOf(overlap.first), BoxOf(overlap.second), Row(overlap.point)));
  }
  return py::make_tuple(branches, touches, overlaps, met.tolerance);
}

// ([(point, first, second, tangential)], [(first, second)])
py::tuple Curves(const BodyPtr& first, const BodyPtr& second, double tolerance) {
  return WithCurve(*first, [&]<int Dim>(const NurbsCurve<Dim>& a) {
    const auto* b = std::get_if<NurbsCurve<Dim>>(&second->geometry());
    if (!b) throw py::value_error("first, second: one lies in the plane, the other in space");
    const auto met =
        Watched([a, b = *b, tolerance](Watch&) { return IntersectCurves(a, b, tolerance); });
    py::list points, overlaps;
    for (const auto& one : met.points) {
      points.append(py::make_tuple(Row(one.point), one.first, one.second, one.tangential));
    }
    for (const auto& one : met.overlaps) {
      overlaps.append(py::make_tuple(std::pair(one.first.lower, one.first.upper),
                                     std::pair(one.second.lower, one.second.upper)));
    }
    return py::make_tuple(points, overlaps);
  });
}

// ([(point, on curve, on surface, tangential)], [(on curve, from, to)])
py::tuple CurveAndSurface(const BodyPtr& curve, const BodyPtr& surface, double tolerance) {
  const auto* spatial = std::get_if<NurbsCurve<3>>(&curve->geometry());
  if (!spatial) throw py::value_error("first: a plane curve can't meet a surface in space");
  surface->surface();
  const auto met = Watched([spatial = *spatial, surface, tolerance](Watch&) {
    return IntersectCurveSurface(spatial, surface->surface(), tolerance);
  });
  py::list points, overlaps;
  for (const auto& one : met.points) {
    points.append(
        py::make_tuple(Row(one.point), one.on_curve, Row(one.on_surface), one.tangential));
  }
  for (const auto& one : met.overlaps) {
    overlaps.append(py::make_tuple(
        std::pair(one.on_curve.lower, one.on_curve.upper), Row(one.from), Row(one.to)));
  }
  return py::make_tuple(points, overlaps);
}

// (bodies, exact, deviation, places where it meets itself, tolerance reached)
py::tuple Offset(const BodyPtr& body,
                 double distance,
                 const std::optional<double>& tolerance,
                 const std::array<double, 3>& xyz,
                 bool trim_loops) {
  const Eigen::Vector3d normal(xyz[0], xyz[1], xyz[2]);
  const OffsetOptions options{.tolerance = tolerance};
  py::list places;
  if (body->is_surface()) {
    const SurfaceOffset offset =
        Watched([=](Watch&) { return OffsetSurface(body->surface(), distance, options); });
    for (const auto& one : offset.self_meetings) places.append(Row(one.point));
    return py::make_tuple(MakeBodies(std::vector{offset.surface}),
                          offset.exact,
                          offset.deviation,
                          places,
                          offset.tolerance_reached);
  }
  return WithCurve(*body, [&]<int Dim>(const NurbsCurve<Dim>& curve) {
    const auto [offset, kept] = Watched([=](Watch&) {
      const CurveOffset<Dim> whole = [&] {
        if constexpr (Dim == 2) {
          return OffsetCurve(curve, distance, options);
        } else {
          return OffsetCurve(curve, normal, distance, options);
        }
      }();
      std::vector<NurbsCurve<Dim>> curves{whole.curve};
      if (trim_loops) curves = WithoutLoops(whole, curve, distance, options);
      return std::pair(whole, std::move(curves));
    });
    for (const auto& one : offset.self_meetings) places.append(Row(one.point));
    return py::make_tuple(MakeBodies(kept), offset.exact, offset.deviation, places, true);
  });
}

}  // namespace

void BindMeets(py::module_& m) {
  m.def("intersect_surfaces", &Surfaces);
  m.def("intersect_curves", &Curves);
  m.def("intersect_curve_surface", &CurveAndSurface);
  m.def("offset", &Offset);
}

}  // namespace batten::python
