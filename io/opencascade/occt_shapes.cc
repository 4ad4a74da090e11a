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

void CheckRange(const Geometry& geometry, const std::string& what, const std::string& path) {
  const double largest = std::visit(
      [](const auto& one) { return one.control_points().cwiseAbs().maxCoeff(); }, geometry);
  if (!(largest <= kLargestCoordinate)) {
    throw ReadError(path, what + " has a coordinate above 1e150 in magnitude");
  }
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
    const TopoDS_Face face = TopoDS::Face(shape);
    FaceWires wires = AddFace(face);
    if (body != nullptr) body->push_back({face, contents_.geometry.size() - 1, std::move(wires)});
    return;
  }
  if (type > TopAbs_FACE) return;
  if (body == nullptr && (type == TopAbs_SOLID || type == TopAbs_SHELL)) return AddBody(shape);
  for (TopoDS_Iterator parts(shape); parts.More(); parts.Next()) AddFaces(parts.Value(), body);
}

// Shells of one face share nothing.
void ShapeCollector::AddBody(const TopoDS_Shape& shape) {
  std::vector<BodyFace> faces;
  for (TopoDS_Iterator parts(shape); parts.More(); parts.Next()) AddFaces(parts.Value(), &faces);
  const bool solid = shape.ShapeType() == TopAbs_SOLID;
  if (faces.empty() || (faces.size() == 1 && !solid)) return;
  GeometryBody one = BodyOf(faces);
  one.solid = solid;
  if (names_) one.name = names_(shape);
  contents_.bodies.push_back(std::move(one));
}

FaceWires ShapeCollector::AddFace(const TopoDS_Face& face) {
  const std::string name = "face " + std::to_string(++faces_);
  if (BRep_Tool::Surface(face).IsNull()) throw ReadError(path_, name + " has no surface");
  FaceWires wires;
  Keep(name, face, [&] {
    FaceShape shape = FaceToNurbs(face);
    wires = std::move(shape.wires);
    return std::move(shape.surface);
  });
  return wires;
}

void ShapeCollector::AddEdge(const TopoDS_Edge& edge) {
  double first = 0, last = 0;
  if (BRep_Tool::Degenerated(edge)) return;
  const std::string name = "edge " + std::to_string(++edges_);
  if (BRep_Tool::Curve(edge, first, last).IsNull()) throw ReadError(path_, name + " has no curve");
  Keep(name, edge, [&] { return ToNurbs(edge); });
}

template <typename Convert>
void ShapeCollector::Keep(const std::string& name, const TopoDS_Shape& shape, Convert convert) {
  try {
    contents_.geometry.emplace_back(convert());
    contents_.names.push_back(names_ ? names_(shape) : "");
  } catch (const std::invalid_argument& error) {
    throw ReadError(path_, name + ": " + error.what());
  } catch (const Standard_Failure& failure) {
    throw ReadError(path_, name + " can't be turned into NURBS: " + failure.GetMessageString());
  }
  CheckRange(contents_.geometry.back(), name, path_);
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
