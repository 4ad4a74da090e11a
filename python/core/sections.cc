// SPDX-License-Identifier: MIT
// Meshes of surfaces, plane sections, cuts and trims.
#include <pybind11/stl.h>

#include "batten/geometry/cut_surface.h"
#include "batten/geometry/plane_section.h"
#include "batten/geometry/project_curve.h"
#include "batten/geometry/tessellate.h"
#include "batten/geometry/trim_loops.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/body.h"
#include "python/core/watch.h"

namespace batten::python {
namespace {

using Pieces = std::pair<std::vector<BodyPtr>, std::vector<BodyPtr>>;

double SizeOf(const NurbsSurface& surface) {
  const auto& points = surface.control_points();
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

// (vertices, faces, parameters, normals)
py::tuple Mesh(const BodyPtr& body, double tolerance, Eigen::Index max_triangles) {
  body->surface();
  TriangleMesh mesh = Watched([=](Watch& watch) {
    TessellateOptions options{tolerance, max_triangles, nullptr};
    options.progress = [&](double fraction) {
      if (!watch.Go("tessellate", fraction)) throw Cancelled();
    };
    return Tessellate(body->surface(), options);
  });
  const py::ssize_t vertices = mesh.vertices.cols(), faces = mesh.triangles.cols();
  return py::make_tuple(Owned(std::move(mesh.vertices), {vertices, 3}),
                        Owned(std::move(mesh.triangles), {faces, 3}),
                        Owned(std::move(mesh.parameters), {vertices, 2}),
                        Owned(std::move(mesh.normals), {vertices, 3}));
}

Plane PlaneOf(const std::array<double, 4>& abcd) { return {{abcd[0], abcd[1], abcd[2]}, -abcd[3]}; }

std::vector<BodyPtr> SectionOf(const BodyPtr& body,
                               const std::array<double, 4>& abcd,
                               const std::optional<double>& tolerance) {
  constexpr double kToleranceOfSize = 1e-4, kOneEnd = 1e-8;  // as the program has them
  body->surface();
  auto curves = Watched([=](Watch&) {
    const NurbsSurface& surface = body->surface();
    const double size = SizeOf(surface);
    const SectionOptions options{.tolerance = tolerance.value_or(kToleranceOfSize * size)};
    const PlaneSection section = SectionInside(surface, Section(surface, PlaneOf(abcd), options));
    std::vector<NurbsCurve<3>> found;
    for (const auto* some : {&section.curves, &section.edges})
      for (const SectionCurve& curve : *some) found.push_back(curve.points);
    return found.empty() ? found : JoinedInSpace(std::move(found), kOneEnd * size);
  });
  return MakeBodies(std::move(curves));
}

Pieces ToPieces(SurfaceCut cut) {
  return {MakeBodies(std::move(cut.left)), MakeBodies(std::move(cut.right))};
}

Pieces CutAt(const BodyPtr& body,
             const std::array<double, 4>& abcd,
             const std::optional<double>& tolerance) {
  body->surface();
  return ToPieces(Watched([=](Watch&) {
    return CutByPlane(body->surface(), PlaneOf(abcd), {.tolerance = tolerance});
  }));
}

Pieces TrimAlong(const BodyPtr& body,
                 const BodyPtr& curve,
                 const std::optional<double>& tolerance) {
  constexpr double kToleranceOfSize = 1e-8;
  const double size = SizeOf(body->surface());
  if (curve->is_surface()) throw py::value_error("curve: a curve is needed, not a surface");
  return ToPieces(Watched([=](Watch&) {
    if (const auto* plane = std::get_if<NurbsCurve<2>>(&curve->geometry()))
      return CutAlong(body->surface(), *plane);
    return CutAlong(body->surface(),
                    std::get<NurbsCurve<3>>(curve->geometry()),
                    tolerance.value_or(kToleranceOfSize * size));
  }));
}

std::vector<BodyPtr> Project(const BodyPtr& body, const BodyPtr& curve, double tolerance) {
  const auto* space = std::get_if<NurbsCurve<3>>(&curve->geometry());
  if (!space) throw py::value_error("curve: a curve in space is needed");
  body->surface();
  return MakeBodies(Watched([=](Watch&) {
    return ProjectedCurve(body->surface(), std::get<NurbsCurve<3>>(curve->geometry()), tolerance);
  }));
}

}  // namespace

void BindSections(py::module_& m) {
  m.def("mesh", &Mesh);
  m.def("section", &SectionOf);
  m.def("cut", &CutAt);
  m.def("trim", &TrimAlong);
  m.def("project_curve", &Project);
  m.def("check_trims", [](const Body& b) { CheckTrims(b.surface()); });
}

}  // namespace batten::python
