// SPDX-License-Identifier: MIT
#include "io/opencascade/occt_shapes.h"

#include <BRep_Tool.hxx>
#include <GeomConvert.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Iterator.hxx>
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "batten/io/read_error.h"
#include "io/opencascade/body_edges.h"
#include "io/opencascade/occt_convert.h"
#include "io/opencascade/occt_exact.h"
#include "io/opencascade/occt_face.h"

namespace batten::internal {
namespace {

constexpr double kLargestCoordinate = 1e150;

// The NURBS form on the whole domain, of analytic shapes as batten makes them; what was periodic
// comes back clamped.
NurbsCurve<3> ToNurbs(const Handle(Geom_Curve) & curve, double first, double last, bool closed) {
  if (const auto exact = FromAnalytic(curve, first, last, closed)) return ToNurbs(*exact);
  const double slack = 1e-12 * (last - first);
  Handle(Geom_BSplineCurve) bspline = Handle(Geom_BSplineCurve)::DownCast(curve);
  const bool whole = !bspline.IsNull() && !bspline->IsPeriodic() &&
                     std::abs(first - bspline->FirstParameter()) <= slack &&
                     std::abs(last - bspline->LastParameter()) <= slack;
  if (!whole) {
    bspline = GeomConvert::CurveToBSplineCurve(new Geom_TrimmedCurve(curve, first, last));
    if (bspline->IsPeriodic()) bspline->SetNotPeriodic();
    bspline->Segment(bspline->FirstParameter(), bspline->LastParameter());
  }
  return FromOcct(*bspline);
}

NurbsCurve<3> ToNurbs(const TopoDS_Edge& edge) {
  double first = 0, last = 0;
  Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
  if (edge.Orientation() == TopAbs_REVERSED) {
    const double swap = curve->ReversedParameter(first);
    first = curve->ReversedParameter(last);
    last = swap;
    curve = curve->Reversed();
  }
  return ToNurbs(curve, first, last, BRep_Tool::IsClosed(edge));
}

bool InRange(const Geometry& geometry) {
  const double largest = std::visit(
      [](const auto& one) { return one.control_points().cwiseAbs().maxCoeff(); }, geometry);
  return largest <= kLargestCoordinate;
}

}  // namespace

void ShapeCollector::Add(const TopoDS_Shape& root) {
  AddFaces(root, nullptr);
  for (TopExp_Explorer edges(root, TopAbs_EDGE, TopAbs_FACE); edges.More(); edges.Next()) {
    AddEdge(TopoDS::Edge(edges.Current()));
  }
}

// In the order of an explorer's visits.
void ShapeCollector::AddFaces(const TopoDS_Shape& shape, std::vector<BodyFace>* body) {
  const TopAbs_ShapeEnum type = shape.ShapeType();
  if (type == TopAbs_FACE) {
    if (body == nullptr) KeepShape(shape);
    return AddFace(TopoDS::Face(shape), body);
  }
  if (type > TopAbs_FACE) return;
  if (body == nullptr && (type == TopAbs_SOLID || type == TopAbs_SHELL)) return AddBody(shape);
  for (TopoDS_Iterator parts(shape); parts.More(); parts.Next()) AddFaces(parts.Value(), body);
}

// Shells of one face share nothing.
void ShapeCollector::AddBody(const TopoDS_Shape& shape) {
  const size_t part = held_.parts.size();
  KeepShape(shape);
  std::vector<BodyFace> faces;
  for (TopoDS_Iterator parts(shape); parts.More(); parts.Next()) AddFaces(parts.Value(), &faces);
  const bool solid = shape.ShapeType() == TopAbs_SOLID;
  if (faces.empty() || (faces.size() == 1 && !solid)) return;
  GeometryBody one = BodyOf(faces);
  one.solid = solid;
  one.name = NameIn(shape);
  contents_.bodies.push_back(std::move(one));
  held_.bodies.push_back(part);
}

// A body without a name of its own has that of all its faces.
void ShapeCollector::KeepShape(const TopoDS_Shape& shape) {
  ExportPart part{shape, NameIn(shape), {}};
  bool alike = true;
  if (shape.ShapeType() < TopAbs_FACE) {
    for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next()) {
      part.faces.emplace_back(faces.Current(), NameIn(faces.Current()));
      alike = alike && part.faces.back().second == part.faces[0].second;
    }
  }
  if (part.name.empty() && alike && !part.faces.empty()) part.name = part.faces[0].second;
  held_.parts.push_back(std::move(part));
}

void ShapeCollector::AddFace(const TopoDS_Face& face, std::vector<BodyFace>* body) {
  FaceWires wires;
  const bool kept = Keep("face " + std::to_string(++faces_), face, [&] {
    if (BRep_Tool::Surface(face).IsNull()) {
      writable_ = false;
      throw std::invalid_argument("has no surface");
    }
    FaceShape shape = FaceToNurbs(face);
    wires = std::move(shape.wires);
    return std::move(shape.surface);
  });
  if (kept && body != nullptr) {
    body->push_back({face, contents_.geometry.size() - 1, std::move(wires)});
  }
}

void ShapeCollector::AddEdge(const TopoDS_Edge& edge) {
  if (BRep_Tool::Degenerated(edge)) return;
  KeepShape(edge);
  Keep("edge " + std::to_string(++edges_), edge, [&] {
    double first = 0, last = 0;
    if (BRep_Tool::Curve(edge, first, last).IsNull()) {
      writable_ = false;
      throw std::invalid_argument("has no curve");
    }
    return ToNurbs(edge);
  });
}

template <typename Convert>
bool ShapeCollector::Keep(const std::string& name, const TopoDS_Shape& shape, Convert convert) {
  std::string why;
  try {
    Geometry geometry = convert();
    if (InRange(geometry)) {
      contents_.geometry.push_back(std::move(geometry));
      contents_.names.push_back(NameIn(shape));
      return true;
    }
    why = " has a coordinate above 1e150 in magnitude";
    writable_ = false;
  } catch (const std::invalid_argument& error) {
    why = std::string(": ") + error.what();
  } catch (const Standard_Failure& failure) {
    why = std::string(" can't be turned into NURBS: ") + failure.GetMessageString();
  }
  contents_.unread.push_back(name + why);
  return false;
}

void ShapeCollector::TellLost(const std::vector<std::string>& lost) {
  contents_.unread.insert(contents_.unread.end(), lost.begin(), lost.end());
  contents_.shapes.whole = lost.empty();
}

void ShapeCollector::Finish() {
  if (writable_) contents_.shapes.held = std::make_shared<HeldShapes>(std::move(held_));
}

void RequireGeometry(const GeometryContents& contents,
                     const std::string& path,
                     const std::string& empty) {
  if (!contents.geometry.empty()) return;
  throw ReadError(path, contents.unread.empty() ? empty : contents.unread[0]);
}

std::string WhatIsFlattened(const GeometryContents& contents, int placed_parts) {
  const auto solids = std::count_if(
      contents.bodies.begin(), contents.bodies.end(), [](const auto& body) { return body.solid; });
  if (solids == 0 && placed_parts == 0) return "";
  const std::string parts = "an assembly of " + std::to_string(placed_parts) + " placed parts";
  const std::string bodies = solids == 1 ? "a solid" : std::to_string(solids) + " solids";
  return (placed_parts == 0 ? bodies
          : solids == 0     ? parts
                            : parts + " with " + bodies) +
         (placed_parts == 0 && solids > 1 ? " are" : " is") + std::string(" flattened: ") +
         std::to_string(contents.geometry.size()) +
         " surfaces and curves where they stand, each by itself";
}

}  // namespace batten::internal
