// SPDX-License-Identifier: MIT
#include "io/opencascade/face_loops.h"

#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <Geom2dConvert.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_BoundedCurve.hxx>
#include <Geom2d_Line.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <Geom_Surface.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "batten/geometry/bounding_box.h"
#include "batten/geometry/reverse.h"
#include "geometry/nurbs/placed_curve.h"
#include "io/opencascade/occt_convert.h"

namespace batten::internal {
namespace {

using Wire = std::vector<NurbsCurve<2>>;

// In the order in which they follow one another, where OpenCASCADE finds one.
std::vector<TopoDS_Edge> EdgesOf(const TopoDS_Wire& wire, const TopoDS_Face& face) {
  std::vector<TopoDS_Edge> stored, connected;
  for (TopoDS_Iterator edges(wire); edges.More(); edges.Next()) {
    stored.push_back(TopoDS::Edge(edges.Value()));
  }
  for (BRepTools_WireExplorer edges(wire, face); edges.More(); edges.Next()) {
    connected.push_back(edges.Current());
  }
  return connected.size() == stored.size() ? connected : stored;
}

Handle(Geom2d_Curve) BasisOf(const Handle(Geom2d_Curve) & curve) {
  const auto part = Handle(Geom2d_TrimmedCurve)::DownCast(curve);
  return part.IsNull() ? curve : BasisOf(part->BasisCurve());
}

// Whether OpenCASCADE's B-spline of a curve has its parameters.
bool KeepsSpeed(const Handle(Geom2d_Curve) & curve) {
  const Handle(Geom2d_Curve) basis = BasisOf(curve);
  return basis->IsKind(STANDARD_TYPE(Geom2d_Line)) ||
         basis->IsKind(STANDARD_TYPE(Geom2d_BoundedCurve));
}

NurbsCurve<2> PacedCurve(const Geom2d_Curve& curve, double first, double last) {
  constexpr double kNear = 1e-7;  // of the size
  constexpr int kPlaces = 16;
  Eigen::AlignedBox2d box;
  const auto node_at = [&](double t) {
    gp_Pnt2d point;
    gp_Vec2d slope;
    curve.D1(t, point, slope);
    return CurveNode{t, {point.X(), point.Y()}, {slope.X(), slope.Y()}};
  };
  for (int k = 0; k <= kPlaces; ++k) {
    box.extend(node_at(first + (last - first) * k / kPlaces).point);
  }
  return CubicOf(node_at, first, last, Eigen::Array2d::Constant(kNear * box.diagonal().norm()));
}

NurbsCurve<2> CurveOf(const TopoDS_Edge& edge, const TopoDS_Face& face, CurveSpeed speed) {
  double first = 0, last = 0;
  const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (curve.IsNull()) throw std::invalid_argument("an edge has no curve on the surface");
  const auto turned = [&](const NurbsCurve<2>& one) {
    return edge.Orientation() == TopAbs_REVERSED ? Reversed(one) : one;
  };
  if (speed == CurveSpeed::kKept && !KeepsSpeed(curve))
    return turned(PacedCurve(*curve, first, last));
  auto bspline = Handle(Geom2d_BSplineCurve)::DownCast(curve);
  const double slack = 1e-12 * (last - first);
  const bool whole = !bspline.IsNull() && std::abs(first - bspline->FirstParameter()) <= slack &&
                     std::abs(last - bspline->LastParameter()) <= slack;
  if (whole && bspline->IsPeriodic()) {
    bspline = Handle(Geom2d_BSplineCurve)::DownCast(bspline->Copy());
    bspline->SetNotPeriodic();
    bspline->Segment(first, last);
  } else if (!whole) {
    bspline = Geom2dConvert::CurveToBSplineCurve(new Geom2d_TrimmedCurve(curve, first, last));
    if (bspline->IsPeriodic()) bspline->SetNotPeriodic();
    bspline->Segment(bspline->FirstParameter(), bspline->LastParameter());
  }
  return turned(FromOcct(*bspline));
}

NurbsCurve<2> Moved(const NurbsCurve<2>& curve, const Eigen::Vector2d& by) {
  if (by.isZero(0)) return curve;
  return Translated(curve, by);
}

Eigen::Vector2d Start(const NurbsCurve<2>& curve) { return curve.At(curve.basis().lower()); }
Eigen::Vector2d End(const NurbsCurve<2>& curve) { return curve.At(curve.basis().upper()); }

// Zero where there is no period.
Eigen::Vector2d PeriodsOf(const TopoDS_Face& face) {
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  return {surface->IsUPeriodic() ? surface->UPeriod() : 0,
          surface->IsVPeriodic() ? surface->VPeriod() : 0};
}

// By whole periods, the nearest.
Eigen::Vector2d WholePeriods(const Eigen::Vector2d& by, const Eigen::Vector2d& periods) {
  Eigen::Vector2d whole = Eigen::Vector2d::Zero();
  for (int k = 0; k < 2; ++k) {
    if (periods[k] > 0) whole[k] = periods[k] * std::round(by[k] / periods[k]);
  }
  return whole;
}

Eigen::AlignedBox2d Around(const Wire& wire) {
  Eigen::AlignedBox2d box;
  for (const NurbsCurve<2>& curve : wire) box.extend(BoundingBox(curve));
  return box;
}

}  // namespace

std::vector<std::vector<TopoDS_Edge>> EdgesOfWires(const TopoDS_Face& face) {
  std::vector<std::vector<TopoDS_Edge>> wires;
  for (TopExp_Explorer explorer(face, TopAbs_WIRE); explorer.More(); explorer.Next()) {
    wires.push_back(EdgesOf(TopoDS::Wire(explorer.Current()), face));
    if (wires.back().empty()) wires.pop_back();
  }
  return wires;
}

std::vector<Wire> WiresOf(const TopoDS_Face& face, CurveSpeed speed) {
  const Eigen::Vector2d periods = PeriodsOf(face);
  std::vector<Wire> wires;
  for (const std::vector<TopoDS_Edge>& edges : EdgesOfWires(face)) {
    Wire wire;
    for (const TopoDS_Edge& edge : edges) {
      NurbsCurve<2> curve = CurveOf(edge, face, speed);
      if (!wire.empty()) {
        curve = Moved(curve, WholePeriods(End(wire.back()) - Start(curve), periods));
      }
      wire.push_back(std::move(curve));
    }
    wires.push_back(std::move(wire));
  }
  if (wires.empty() || periods.isZero(0)) return wires;
  const Eigen::AlignedBox2d outer = Around(wires[0]);
  for (size_t i = 1; i < wires.size(); ++i) {
    const Eigen::Vector2d by = WholePeriods(outer.center() - Around(wires[i]).center(), periods);
    for (NurbsCurve<2>& curve : wires[i]) curve = Moved(curve, by);
  }
  return wires;
}

ParameterRectangle BoxOf(const std::vector<Wire>& wires) {
  Eigen::AlignedBox2d box;
  for (const Wire& wire : wires) box.extend(Around(wire));
  return {box.min()[0], box.max()[0], box.min()[1], box.max()[1]};
}

}  // namespace batten::internal
