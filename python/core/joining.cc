// SPDX-License-Identifier: MIT
// Conics, and what joins curves and surfaces: blends, fills, chains, continuations.
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <vector>

#include "batten/geometry/blend.h"
#include "batten/geometry/conic_arc.h"
#include "batten/geometry/curve_chain.h"
#include "batten/geometry/fill.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/body.h"

namespace batten::python {
namespace {

using namespace pybind11::literals;

SurfaceEdge EdgeOf(const std::string& word) {
  return {word[0] == 'u' ? Direction::kU : Direction::kV, word[1] == '1'};
}

std::optional<SurfaceEdge> EdgeOf(const std::optional<std::string>& word) {
  if (!word) return std::nullopt;
  return EdgeOf(*word);
}

BodyPtr BlendTwo(const Body& first,
                 const Body& second,
                 int continuity,
                 const std::pair<double, double>& fullness,
                 const std::optional<std::string>& from,
                 const std::optional<std::string>& to) {
  const BlendOptions options{continuity, {fullness.first, fullness.second}};
  const auto* a = std::get_if<NurbsSurface>(&first.geometry());
  const auto* b = std::get_if<NurbsSurface>(&second.geometry());
  if (a && b) return MakeBody(Blend(*a, *b, options, EdgeOf(from), EdgeOf(to)).surface);
  std::optional<CurveEnds> ends;
  if (from && to) ends = CurveEnds{*from == "end", *to == "end"};
  const auto* p = std::get_if<NurbsCurve<3>>(&first.geometry());
  const auto* q = std::get_if<NurbsCurve<3>>(&second.geometry());
  if (p && q) return MakeBody(Blend(*p, *q, options, ends));
  const auto* s = std::get_if<NurbsCurve<2>>(&first.geometry());
  const auto* t = std::get_if<NurbsCurve<2>>(&second.geometry());
  if (s && t) return MakeBody(Blend(*s, *t, options, ends));
  throw py::value_error("blend: two curves of one dimension or two surfaces are needed");
}

template <int Dim>
std::vector<NurbsCurve<Dim>> CurvesOf(const std::vector<BodyPtr>& bodies) {
  std::vector<NurbsCurve<Dim>> curves;
  for (const BodyPtr& body : bodies) {
    const auto* curve = std::get_if<NurbsCurve<Dim>>(&body->geometry());
    if (!curve) throw py::value_error("curves: curves of one dimension are needed");
    curves.push_back(*curve);
  }
  return curves;
}

BodyPtr Chain(const std::vector<BodyPtr>& bodies, double tolerance) {
  if (bodies.empty()) throw py::value_error("curves: there is none");
  if (std::holds_alternative<NurbsCurve<2>>(bodies[0]->geometry())) {
    return MakeBody(Unified(CurvesOf<2>(bodies), tolerance));
  }
  return MakeBody(Unified(CurvesOf<3>(bodies), tolerance));
}

using Side = std::pair<BodyPtr, std::optional<std::string>>;

py::tuple FillHole(const std::vector<Side>& given, std::optional<double> tolerance, double angle) {
  std::vector<FillSide> sides;
  for (const auto& [body, edge] : given) {
    if (const auto* surface = std::get_if<NurbsSurface>(&body->geometry()); surface && edge) {
      sides.push_back(SideOf(*surface, EdgeOf(*edge)));
    } else if (const auto* curve = std::get_if<NurbsCurve<3>>(&body->geometry()); curve && !edge) {
      sides.push_back({*curve});
    } else {
      throw py::value_error("sides: curves in space, or pairs of a surface and its edge");
    }
  }
  HoleFill fill;
  {
    const py::gil_scoped_release release;
    fill = Fill(sides, {.tolerance = tolerance, .angle_tolerance = angle});
  }
  std::vector<BodyPtr> patches;
  for (NurbsSurface& patch : fill.patches) patches.push_back(MakeBody(std::move(patch)));
  return py::make_tuple(patches,
                        py::dict("position_gap"_a = fill.quality.position_gap,
                                 "inner_angle"_a = fill.quality.inner_angle,
                                 "outer_angle"_a = fill.quality.outer_angle,
                                 "tolerance"_a = fill.tolerance,
                                 "reached"_a = fill.reached));
}

}  // namespace

void BindJoining(py::module_& m) {
  m.def(
      "conic_through",
      [](const Doubles& p, const Doubles& t, const Doubles& q, const Doubles& s, const Doubles& x) {
        return MakeBody(
            ToNurbs(ConicArcThrough<3>(Vector(p), Vector(t), Vector(q), Vector(s), Vector(x))));
      });
  m.def(
      "conic_of_rho",
      [](const Doubles& p, const Doubles& t, const Doubles& q, const Doubles& s, double rho) {
        return MakeBody(ToNurbs(ConicArcOfRho<3>(Vector(p), Vector(t), Vector(q), Vector(s), rho)));
      });
  m.def("conic_of_points", [](const std::vector<Doubles>& points) {
    Eigen::Matrix<double, 3, 5> columns;
    for (int k = 0; k < 5; ++k) columns.col(k) = Vector(points[k]);
    return MakeBody(ToNurbs(ConicArcThroughFive<3>(columns)));
  });
  m.def("blend", &BlendTwo);
  m.def("chain", &Chain);
  m.def("fill", &FillHole);
}

}  // namespace batten::python
