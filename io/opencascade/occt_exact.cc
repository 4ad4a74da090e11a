// SPDX-License-Identifier: MIT
#include "io/opencascade/occt_exact.h"
#include "geometry/numeric/constants.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Precision.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

namespace batten::internal {
namespace {

gp_Pnt ToPoint(const Eigen::Vector3d& p) { return gp_Pnt(p.x(), p.y(), p.z()); }
gp_Dir ToDirection(const Eigen::Vector3d& d) { return gp_Dir(d.x(), d.y(), d.z()); }
gp_Ax3 ToAxes(const Frame& frame) {
  return gp_Ax3(ToPoint(frame.origin()), ToDirection(frame.axis()), ToDirection(frame.x()));
}

Eigen::Vector3d ToVector(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }
Frame ToFrame(const gp_Ax3& axes) {
  return Frame(ToVector(axes.Location().XYZ()),
               ToVector(axes.Direction().XYZ()),
               ToVector(axes.XDirection().XYZ()));
}

// A frame with the angles of an arc about its axis. Part of a turn lies in the middle of 0 … 2π:
// places that rounding moves across the end would be taken for a turn away. A whole one begins at
// 0.
struct Placed {
  Placed(const Frame& frame, const AngleRange& angles)
      : first(angles.full() ? 0 : (kTurn - angles.sweep) / 2),
        last(first + angles.sweep),
        axes(ToAxes(Turned(frame, angles.start - first))) {}

  static Frame Turned(const Frame& f, double angle) {
    if (angle == 0) return f;
    return Frame(f.origin(), f.axis(), std::cos(angle) * f.x() + std::sin(angle) * f.y());
  }

  double first, last;
  gp_Ax3 axes;
};

std::optional<TopoDS_Shape> Face(
    const Handle(Geom_Surface) & surface, double u0, double u1, double v0, double v1) {
  BRepBuilderAPI_MakeFace face(surface, u0, u1, v0, v1, Precision::Confusion());
  if (!face.IsDone() || !BRepCheck_Analyzer(face.Shape()).IsValid()) return std::nullopt;
  return face.Shape();
}

// Whether OpenCASCADE's reader leaves a cone with its tip as it is. Measured: at coordinates of 1e4
// radii all of 2000, at 1e5 it turns a tenth into other surfaces.
bool TipSurvives(const Frame& frame, double radius) {
  constexpr double kFarthest = 1e4;
  return frame.origin().cwiseAbs().maxCoeff() <= kFarthest * radius;
}

struct MakeFace {
  std::optional<TopoDS_Shape> operator()(const ExactPlane& s) const {
    return Face(new Geom_Plane(ToAxes(s.frame)), s.x.lower, s.x.upper, s.y.lower, s.y.upper);
  }

  std::optional<TopoDS_Shape> operator()(const ExactCylinder& s) const {
    const Placed at(s.frame, s.angles);
    return Face(new Geom_CylindricalSurface(at.axes, s.radius),
                at.first,
                at.last,
                s.height.lower,
                s.height.upper);
  }

  // From the wide end, for a radius must be positive; angles of cones are.
  std::optional<TopoDS_Shape> operator()(const ExactCone& s) const {
    const bool widens = s.radius_upper > s.radius_lower;
    const double over = std::abs(s.radius_upper - s.radius_lower);
    const double height = s.height.upper - s.height.lower;
    const Frame& f = s.frame;
    const double end = s.angles.start + s.angles.sweep;
    const Placed at = widens ? Placed(Frame(f.At(0, 0, s.height.upper), f.axis(), f.x()), s.angles)
                             : Placed(Frame(f.At(0, 0, s.height.lower), -f.axis(), f.x()),
                                      {-end, s.angles.sweep});
    const double radius = std::max(s.radius_lower, s.radius_upper);
    const bool tip = std::min(s.radius_lower, s.radius_upper) == 0;
    if (tip && !TipSurvives(f, radius)) return std::nullopt;
    return Face(new Geom_ConicalSurface(at.axes, std::atan2(over, height), radius),
                at.first,
                at.last,
                -std::hypot(over, height),
                0);
  }

  std::optional<TopoDS_Shape> operator()(const ExactSphere& s) const {
    const Placed at(s.frame, s.longitude);
    return Face(new Geom_SphericalSurface(at.axes, s.radius),
                at.first,
                at.last,
                s.latitude.lower,
                s.latitude.upper);
  }

  std::optional<TopoDS_Shape> operator()(const ExactTorus& s) const {
    constexpr double kRounding = 1e-9;
    const bool whole = s.tube.full();
    if (whole && std::abs(s.tube.start) > kRounding) return std::nullopt;
    if (s.minor >= s.major) return std::nullopt;
    const Placed at(s.frame, s.round);
    return Face(new Geom_ToroidalSurface(at.axes, s.major, s.minor),
                at.first,
                at.last,
                whole ? 0 : s.tube.start,
                whole ? kTurn : s.tube.start + s.tube.sweep);
  }
};

// All round where the boundary has a seam: parameters read from it are a turn to rounding only.
AngleRange ToAngles(double first, double last, bool seam) {
  return {first, seam ? kTurn : last - first};
}

std::optional<ExactSurface> ConeOf(const Geom_ConicalSurface& cone,
                                   const ParameterRectangle& box,
                                   const AngleRange& around) {
  constexpr double kTip = 1e-12;
  const double sine = std::sin(cone.SemiAngle()), cosine = std::cos(cone.SemiAngle());
  double lower = cone.RefRadius() + box.v0 * sine, upper = cone.RefRadius() + box.v1 * sine;
  const double widest = std::max(lower, upper);
  if (std::abs(lower) <= kTip * widest) lower = 0;
  if (std::abs(upper) <= kTip * widest) upper = 0;
  if (!(lower >= 0 && upper >= 0 && cosine > 0)) return std::nullopt;
  return ExactCone{
      ToFrame(cone.Position()), lower, upper, {box.v0 * cosine, box.v1 * cosine}, around};
}

}  // namespace

std::optional<TopoDS_Shape> ToAnalyticShape(const ExactCurve& shape) {
  if (const auto* line = std::get_if<ExactLine>(&shape)) {
    BRepBuilderAPI_MakeEdge edge(ToPoint(line->start), ToPoint(line->end));
    if (!edge.IsDone()) return std::nullopt;
    return edge.Shape();
  }
  const ExactArc& arc = std::get<ExactArc>(shape);
  const Handle(Geom_Circle) circle = new Geom_Circle(ToAxes(arc.frame).Ax2(), arc.radius);
  BRepBuilderAPI_MakeEdge edge(circle, arc.angles.start, arc.angles.start + arc.angles.sweep);
  if (!edge.IsDone()) return std::nullopt;
  return edge.Shape();
}

std::optional<TopoDS_Shape> ToAnalyticShape(const ExactSurface& shape) {
  return std::visit(MakeFace(), shape);
}

std::optional<ExactCurve> FromAnalytic(const Handle(Geom_Curve) & curve,
                                       double first,
                                       double last,
                                       bool closed) {
  if (!Handle(Geom_Line)::DownCast(curve).IsNull()) {
    return ExactLine{ToVector(curve->Value(first).XYZ()), ToVector(curve->Value(last).XYZ())};
  }
  const auto circle = Handle(Geom_Circle)::DownCast(curve);
  if (circle.IsNull()) return std::nullopt;
  return ExactArc{
      ToFrame(gp_Ax3(circle->Position())), circle->Radius(), ToAngles(first, last, closed)};
}

std::optional<ExactSurface> FromAnalytic(const Handle(Geom_Surface) & surface,
                                         const ParameterRectangle& box,
                                         const Seams& seams) {
  if (const auto part = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface); !part.IsNull()) {
    return FromAnalytic(part->BasisSurface(), box, seams);
  }
  const auto elementary = Handle(Geom_ElementarySurface)::DownCast(surface);
  if (elementary.IsNull() || !elementary->Position().Direct()) return std::nullopt;
  const Frame frame = ToFrame(elementary->Position());
  const AngleRange around = ToAngles(box.u0, box.u1, seams.u);
  if (!Handle(Geom_Plane)::DownCast(surface).IsNull()) {
    return ExactPlane{frame, {box.u0, box.u1}, {box.v0, box.v1}};
  }
  if (const auto s = Handle(Geom_CylindricalSurface)::DownCast(surface); !s.IsNull()) {
    return ExactCylinder{frame, s->Radius(), {box.v0, box.v1}, around};
  }
  if (const auto s = Handle(Geom_SphericalSurface)::DownCast(surface); !s.IsNull()) {
    return ExactSphere{frame, s->Radius(), around, {box.v0, box.v1}};
  }
  if (const auto s = Handle(Geom_ToroidalSurface)::DownCast(surface); !s.IsNull()) {
    return ExactTorus{
        frame, s->MajorRadius(), s->MinorRadius(), around, ToAngles(box.v0, box.v1, seams.v)};
  }
  if (const auto s = Handle(Geom_ConicalSurface)::DownCast(surface); !s.IsNull()) {
    return ConeOf(*s, box, around);
  }
  return std::nullopt;
}

}  // namespace batten::internal
