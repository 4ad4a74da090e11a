// SPDX-License-Identifier: MIT
#include "io/opencascade/parameter_rectangle.h"
#include "geometry/numeric/constants.h"

#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace batten::internal {
namespace {

constexpr int kSamples = 33;     // along one edge
constexpr double kSlack = 1e-7;  // relative to the rectangle

using Edge = std::array<gp_Pnt2d, kSamples>;

// The boundary in the parameter domain; none when an edge has no curve there.
std::optional<std::vector<Edge>> Boundary(const TopoDS_Face& face) {
  std::vector<Edge> result;
  for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
    double first = 0, last = 0;
    const Handle(Geom2d_Curve) curve =
        BRep_Tool::CurveOnSurface(TopoDS::Edge(edges.Current()), face, first, last);
    if (curve.IsNull()) return std::nullopt;
    Edge& edge = result.emplace_back();
    for (int i = 0; i < kSamples; ++i) {
      edge[i] = curve->Value(first + (last - first) * i / (kSamples - 1));
    }
  }
  if (result.empty()) return std::nullopt;
  return result;
}

int CountWires(const TopoDS_Face& face) {
  int count = 0;
  for (TopExp_Explorer wires(face, TopAbs_WIRE); wires.More(); wires.Next()) ++count;
  return count;
}

ParameterRectangle Around(const std::vector<Edge>& boundary) {
  ParameterRectangle box = {kInfinity, -kInfinity, kInfinity, -kInfinity};
  for (const Edge& edge : boundary) {
    for (const gp_Pnt2d& point : edge) {
      box.u0 = std::min(box.u0, point.X());
      box.u1 = std::max(box.u1, point.X());
      box.v0 = std::min(box.v0, point.Y());
      box.v1 = std::max(box.v1, point.Y());
    }
  }
  return box;
}

// Whether the whole edge lies on one side of the rectangle.
bool OnOneSide(const Edge& edge, const ParameterRectangle& box) {
  const double slack_u = kSlack * (box.u1 - box.u0), slack_v = kSlack * (box.v1 - box.v0);
  const auto all = [&edge](auto near) { return std::all_of(edge.begin(), edge.end(), near); };
  return all([&](const gp_Pnt2d& p) { return std::abs(p.X() - box.u0) <= slack_u; }) ||
         all([&](const gp_Pnt2d& p) { return std::abs(p.X() - box.u1) <= slack_u; }) ||
         all([&](const gp_Pnt2d& p) { return std::abs(p.Y() - box.v0) <= slack_v; }) ||
         all([&](const gp_Pnt2d& p) { return std::abs(p.Y() - box.v1) <= slack_v; });
}

}  // namespace

ParameterRectangle NaturalRectangle(const Geom_Surface& surface) {
  ParameterRectangle natural = {};
  surface.Bounds(natural.u0, natural.u1, natural.v0, natural.v1);
  return natural;
}

std::optional<ParameterRectangle> RectangleOf(const TopoDS_Face& face) {
  if (CountWires(face) != 1) return std::nullopt;
  const auto boundary = Boundary(face);
  if (!boundary) return std::nullopt;
  ParameterRectangle box = Around(*boundary);
  if (!(box.u0 < box.u1 && box.v0 < box.v1)) return std::nullopt;
  const auto on_side = [&box](const Edge& edge) { return OnOneSide(edge, box); };
  if (!std::all_of(boundary->begin(), boundary->end(), on_side)) return std::nullopt;

  const ParameterRectangle natural = NaturalRectangle(*BRep_Tool::Surface(face));
  const double slack_u = kSlack * (box.u1 - box.u0), slack_v = kSlack * (box.v1 - box.v0);
  if (std::abs(box.u0 - natural.u0) <= slack_u) box.u0 = natural.u0;
  if (std::abs(box.u1 - natural.u1) <= slack_u) box.u1 = natural.u1;
  if (std::abs(box.v0 - natural.v0) <= slack_v) box.v0 = natural.v0;
  if (std::abs(box.v1 - natural.v1) <= slack_v) box.v1 = natural.v1;
  return box;
}

Seams SeamsOf(const TopoDS_Face& face) {
  Seams seams;
  // An edge with a curve on either side may bound the face on one of them alone.
  TopTools_MapOfShape once;
  for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(edges.Current());
    if (!BRep_Tool::IsClosed(edge, face) || once.Add(edge)) continue;
    double first = 0, last = 0;
    const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
    if (curve.IsNull()) continue;
    const gp_Vec2d along(curve->Value(first), curve->Value(last));
    (std::abs(along.X()) < std::abs(along.Y()) ? seams.u : seams.v) = true;
  }
  return seams;
}

}  // namespace batten::internal
