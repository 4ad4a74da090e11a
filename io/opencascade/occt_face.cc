// SPDX-License-Identifier: MIT
#include "io/opencascade/occt_face.h"

#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRep_Tool.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_ElementarySurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/join.h"
#include "geometry/nurbs/placed_curve.h"
#include "io/exchange/file_loops.h"
#include "io/exchange/parameter_map.h"
#include "io/opencascade/face_loops.h"
#include "io/opencascade/occt_convert.h"
#include "io/opencascade/occt_exact.h"
#include "io/opencascade/parameter_rectangle.h"

namespace batten::internal {
namespace {

using Wires = std::vector<std::vector<NurbsCurve<2>>>;

constexpr double kMapping = 1e-8;  // of the domain

// A surface with the maps of the face's parameters to its own.
struct Mapping {
  NurbsSurface surface;
  ParameterMap u, v;
};

NurbsSurface Part(const Handle(Geom_Surface) & surface, const ParameterRectangle& box) {
  Handle(Geom_BSplineSurface) bspline = GeomConvert::SurfaceToBSplineSurface(
      new Geom_RectangularTrimmedSurface(surface, box.u0, box.u1, box.v0, box.v1));
  if (bspline->IsUPeriodic()) bspline->SetUNotPeriodic();
  if (bspline->IsVPeriodic()) bspline->SetVNotPeriodic();
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  bspline->Bounds(u0, u1, v0, v1);
  bspline->Segment(u0, u1, v0, v1);
  return FromOcct(*bspline);
}

Handle(Geom_BSplineSurface) AsBSpline(const Handle(Geom_Surface) & surface) {
  return Handle(Geom_BSplineSurface)::DownCast(surface);
}

Handle(Geom_Surface) BasisOf(const Handle(Geom_Surface) & surface) {
  const auto part = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
  return part.IsNull() ? surface : BasisOf(part->BasisSurface());
}

// A face's surface, right-handed where it is a plane or round: u runs the other way where it was
// not, as .brep files may have it. Parameters of the face are turned by U.
struct DirectSurface {
  explicit DirectSurface(const TopoDS_Face& face) : surface(BRep_Tool::Surface(face)) {
    const auto elementary = Handle(Geom_ElementarySurface)::DownCast(BasisOf(surface));
    if (elementary.IsNull() || elementary->Position().Direct()) return;
    sum = elementary->UReversedParameter(0);
    turned = true;
    surface = elementary->UReversed();
  }
  double U(double u) const { return turned ? sum - u : u; }

  Handle(Geom_Surface) surface;
  double sum = 0;  // of u and the parameter it is turned into
  bool turned = false;
};

// Whether a rectangle is all of a B-spline surface, or the surface is of another kind.
bool FillsIt(const Handle(Geom_Surface) & surface, const ParameterRectangle& box) {
  if (AsBSpline(surface).IsNull()) return true;
  const ParameterRectangle natural = NaturalRectangle(*surface);
  const auto as_long = [](double length, double whole) { return length >= (1 - 1e-7) * whole; };
  return as_long(box.u1 - box.u0, natural.u1 - natural.u0) &&
         as_long(box.v1 - box.v0, natural.v1 - natural.v0);
}

// By how many whole periods wires have to move for their box to lie in the natural domain where it
// can.
Eigen::Vector2d WayIntoDomain(const Geom_Surface& surface, const Wires& wires) {
  constexpr double kSlack = 1e-7;
  const ParameterRectangle natural = NaturalRectangle(surface), box = BoxOf(wires);
  const auto step = [](bool periodic, double from, double lower, double upper) {
    if (!periodic) return 0.0;
    const double period = upper - lower;
    return -period * std::floor((from - lower) / period + kSlack);
  };
  return {step(surface.IsUPeriodic(), box.u0, natural.u0, natural.u1),
          step(surface.IsVPeriodic(), box.v0, natural.v0, natural.v1)};
}

void Move(Wires& wires, const Eigen::Vector2d& by) {
  if (by.isZero(0)) return;
  for (auto& wire : wires) {
    for (NurbsCurve<2>& curve : wire) curve = Translated(curve, by);
  }
}

// A B-spline keeps its domain unless a loop passes the end of a period.
Mapping OfBSpline(const Handle(Geom_BSplineSurface) & surface, const ParameterRectangle& box) {
  constexpr double kSlack = 1e-7;
  ParameterRectangle part = NaturalRectangle(*surface);
  if (surface->IsUPeriodic() && box.u1 > part.u1 + kSlack * (part.u1 - part.u0)) {
    part.u0 = box.u0;
    part.u1 = box.u1;
  }
  if (surface->IsVPeriodic() && box.v1 > part.v1 + kSlack * (part.v1 - part.v0)) {
    part.v0 = box.v0;
    part.v1 = box.v1;
  }
  NurbsSurface result =
      surface->IsUPeriodic() || surface->IsVPeriodic() ? Part(surface, part) : FromOcct(*surface);
  const ParameterMap u(part.u0, part.u1, result.basis_u(), false);
  const ParameterMap v(part.v0, part.v1, result.basis_v(), false);
  return {std::move(result), u, v};
}

// Of more than one turn, as the flanks of threads have it, equal shares of less than one each.
std::optional<NurbsSurface> WoundSurface(const Handle(Geom_Surface) & surface,
                                         const ParameterRectangle& box) {
  constexpr double kMost = 500;  // more are no thread's
  const double turns = (box.u1 - box.u0) / (2 * std::numbers::pi);
  if (!surface->IsUPeriodic() || !(turns > 1 + kMapping && turns < kMost)) return std::nullopt;
  const double share = (box.u1 - box.u0) / (std::floor(turns) + 1);
  std::optional<NurbsSurface> wound;
  for (double u = box.u0; u < box.u1 - share / 2; u += share) {
    const auto exact = FromAnalytic(surface, {u, u + share, box.v0, box.v1}, {});
    if (!exact) return std::nullopt;
    const NurbsSurface next = ToNurbs(*exact);
    const double size = next.control_points().cwiseAbs().maxCoeff();
    wound = wound ? Join(*wound, next, Direction::kU, kMapping * size) : next;
  }
  return wound;
}

Mapping OfOther(const Handle(Geom_Surface) & surface,
                const ParameterRectangle& box,
                const Seams& seams) {
  const auto wound = WoundSurface(surface, box);
  const auto exact = wound ? std::nullopt : FromAnalytic(surface, box, seams);
  NurbsSurface result = wound ? *wound : exact ? ToNurbs(*exact) : Part(surface, box);
  const Handle(Geom_Surface) basis = BasisOf(surface);
  const bool both = (wound || exact) && (!Handle(Geom_SphericalSurface)::DownCast(basis).IsNull() ||
                                         !Handle(Geom_ToroidalSurface)::DownCast(basis).IsNull());
  const bool round = (wound || exact) && Handle(Geom_Plane)::DownCast(basis).IsNull();
  const ParameterMap u(box.u0, box.u1, result.basis_u(), round);
  const ParameterMap v(box.v0, box.v1, result.basis_v(), both);
  return {std::move(result), u, v};
}

// Whether places of the wires are the same points of both surfaces.
bool SamePoints(const Geom_Surface& surface, const Mapping& mapping, const Wires& wires) {
  constexpr double kSamePoint = 1e-6;
  constexpr int kPlaces = 16;
  const Eigen::Matrix3Xd& net = mapping.surface.control_points();
  const double size = (net.rowwise().maxCoeff() - net.rowwise().minCoeff()).norm();
  for (const auto& wire : wires) {
    for (const NurbsCurve<2>& curve : wire) {
      const SplineBasis& basis = curve.basis();
      for (int i = 0; i <= kPlaces; ++i) {
        const double share = static_cast<double>(i) / kPlaces;
        const Eigen::Vector2d at =
            curve.At(basis.lower() + share * (basis.upper() - basis.lower()));
        const gp_Pnt there = surface.Value(at[0], at[1]);
        const Eigen::Vector3d here = mapping.surface.At(mapping.u.At(at[0]), mapping.v.At(at[1]));
        if (!((here - Eigen::Vector3d(there.X(), there.Y(), there.Z())).norm() <=
              kSamePoint * size)) {
          return false;
        }
      }
    }
  }
  return true;
}

// The least length of rows and columns of control points.
double LeastExtent(const NurbsSurface& surface) {
  const Eigen::Matrix3Xd& net = surface.control_points();
  const Eigen::Index rows = surface.size_u(), columns = surface.size_v();
  double along_u = 0, along_v = 0;
  for (Eigen::Index j = 0; j < columns; ++j) {
    double length = 0;
    for (Eigen::Index i = 1; i < rows; ++i) {
      length += (net.col(i * columns + j) - net.col((i - 1) * columns + j)).norm();
    }
    along_u = std::max(along_u, length);
  }
  for (Eigen::Index i = 0; i < rows; ++i) {
    double length = 0;
    for (Eigen::Index j = 1; j < columns; ++j) {
      length += (net.col(i * columns + j) - net.col(i * columns + j - 1)).norm();
    }
    along_v = std::max(along_v, length);
  }
  return std::min(along_u, along_v);
}

// How far ends of a loop's pieces may be apart: what the tolerances of its corners, as edges that
// were sewn over a gap have them, are worth in the domain.
double LargestGap(const TopoDS_Face& face, const NurbsSurface& surface) {
  constexpr double kWidest = 0.05;  // wider gaps would change the shape of the face
  double tolerance = 0;
  for (TopExp_Explorer corners(face, TopAbs_VERTEX); corners.More(); corners.Next()) {
    tolerance = std::max(tolerance, BRep_Tool::Tolerance(TopoDS::Vertex(corners.Current())));
  }
  const double extent = LeastExtent(surface);
  return extent > 0 ? std::clamp(2 * tolerance / extent, kCadGap, kWidest) : kCadGap;
}

Wires MappedWires(const Wires& wires, const Mapping& mapping, CurveSpeed speed) {
  const Eigen::Array2d sides = DomainSides(mapping.surface);
  Wires mapped;
  for (const auto& wire : wires) {
    mapped.emplace_back();
    for (const NurbsCurve<2>& curve : wire) {
      mapped.back().push_back(Mapped(curve, mapping.u, mapping.v, sides, kMapping, speed));
    }
  }
  return mapped;
}

void Turn(const DirectSurface& direct, Wires& wires) {
  for (auto& wire : wires) {
    for (NurbsCurve<2>& curve : wire) {
      Eigen::Matrix2Xd points = curve.control_points();
      points.row(0) = points.row(0).unaryExpr([&](double u) { return direct.U(u); });
      curve = NurbsCurve<2>(curve.basis(), points, curve.weights());
    }
  }
}

// What sewing over a gap has stretched beyond a B-spline without a period ends with it.
void KeepOnSurface(const Handle(Geom_Surface) & surface, ParameterRectangle& box, Wires& wires) {
  if (AsBSpline(surface).IsNull()) return;
  const ParameterRectangle natural = NaturalRectangle(*surface);
  Eigen::Array2d lower(natural.u0, natural.v0), upper(natural.u1, natural.v1);
  if (surface->IsUPeriodic()) lower[0] = box.u0, upper[0] = box.u1;
  if (surface->IsVPeriodic()) lower[1] = box.v0, upper[1] = box.v1;
  box = {std::max(box.u0, lower[0]),
         std::min(box.u1, upper[0]),
         std::max(box.v0, lower[1]),
         std::min(box.v1, upper[1])};
  for (auto& wire : wires) {
    for (NurbsCurve<2>& curve : wire) {
      Eigen::Matrix2Xd points = curve.control_points();
      for (auto point : points.colwise()) point = point.array().max(lower).min(upper);
      if (points != curve.control_points()) {
        curve = NurbsCurve<2>(curve.basis(), points, curve.weights());
      }
    }
  }
}

FaceShape Untrimmed(const TopoDS_Face& face, ParameterRectangle box) {
  const DirectSurface direct(face);
  const Handle(Geom_Surface) surface = direct.surface;
  Wires wires = WiresOf(face, CurveSpeed::kKept);
  if (direct.turned) {
    box = {direct.U(box.u1), direct.U(box.u0), box.v0, box.v1};
    Turn(direct, wires);
  }
  const Handle(Geom_BSplineSurface) bspline = AsBSpline(surface);
  KeepOnSurface(surface, box, wires);
  const bool whole = !bspline.IsNull() && !bspline->IsUPeriodic() && !bspline->IsVPeriodic() &&
                     box == NaturalRectangle(*surface);
  const Mapping mapping = whole ? OfBSpline(bspline, box) : OfOther(surface, box, SeamsOf(face));
  FaceShape shape{mapping.surface, {{}, direct.turned}};
  if (SamePoints(*surface, mapping, wires)) {
    shape.wires.curves = MappedWires(wires, mapping, CurveSpeed::kKept);
  }
  return shape;
}

// None where the surface's parameters are not those of a NURBS form.
std::optional<FaceShape> Trimmed(const TopoDS_Face& face) {
  const DirectSurface direct(face);
  const Handle(Geom_Surface) surface = direct.surface;
  Wires wires = WiresOf(face), paced = WiresOf(face, CurveSpeed::kKept);
  if (wires.empty()) throw std::invalid_argument("has no boundary");
  if (direct.turned) {
    Turn(direct, wires);
    Turn(direct, paced);
  }
  const Eigen::Vector2d way = WayIntoDomain(*surface, wires);
  Move(wires, way);
  Move(paced, way);
  const ParameterRectangle box = BoxOf(wires);
  const Handle(Geom_BSplineSurface) bspline = AsBSpline(surface);
  const Mapping mapping =
      bspline.IsNull() ? OfOther(surface, box, SeamsOf(face)) : OfBSpline(bspline, box);
  if (!SamePoints(*surface, mapping, wires)) return std::nullopt;
  const Wires pieces = MappedWires(wires, mapping, CurveSpeed::kAny);
  const double gap = LargestGap(face, mapping.surface);
  const Eigen::Array2d sides = DomainSides(mapping.surface);
  std::vector<NurbsCurve<2>> loops;
  for (size_t i = 0; i < pieces.size(); ++i) {
    try {
      loops.push_back(Shut(Chained(pieces[i], sides, gap, false), sides, gap));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("loop " + std::to_string(i + 1) + ": " + error.what());
    }
  }
  try {
    return FaceShape{WithTurnedLoops(mapping.surface, std::move(loops), gap),
                     {MappedWires(paced, mapping, CurveSpeed::kKept), direct.turned}};
  } catch (const LoopError& error) {
    throw std::invalid_argument("loop " + std::to_string(error.loop() + 1) + " " + error.what());
  }
}

std::optional<FaceShape> AsItStands(const TopoDS_Face& face) {
  const auto box = RectangleOf(face);
  if (box && FillsIt(BRep_Tool::Surface(face), *box)) return Untrimmed(face, *box);
  return Trimmed(face);
}

bool SameEdges(const TopoDS_Face& face, const Wires& wires) {
  const auto edges = EdgesOfWires(face);
  return std::equal(
      edges.begin(), edges.end(), wires.begin(), wires.end(), [](const auto& a, const auto& b) {
        return a.size() == b.size();
      });
}

}  // namespace

FaceShape FaceToNurbs(const TopoDS_Face& face) {
  if (auto shape = AsItStands(face)) return std::move(*shape);
  BRepBuilderAPI_NurbsConvert converted(face);
  auto shape = AsItStands(TopoDS::Face(converted.Shape()));
  if (!shape) {
    throw std::invalid_argument(
        "is trimmed on a surface whose parameters are not those of a NURBS surface");
  }
  if (!SameEdges(face, shape->wires.curves)) shape->wires.curves.clear();
  return std::move(*shape);
}

}  // namespace batten::internal
