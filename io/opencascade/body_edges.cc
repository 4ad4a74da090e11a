// SPDX-License-Identifier: MIT
#include "io/opencascade/body_edges.h"

#include <BRepBndLib.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>

#include "io/opencascade/face_loops.h"

namespace batten::internal {
namespace {

constexpr double kLeastTolerance =
    1e-6;  // of the body's size: what rounding may part in NURBS form

Eigen::Vector3d Place(const TopoDS_Vertex& vertex) {
  if (vertex.IsNull()) return Eigen::Vector3d::Zero();
  const gp_Pnt point = BRep_Tool::Pnt(vertex);
  return {point.X(), point.Y(), point.Z()};
}

double ToleranceOf(const TopoDS_Edge& edge) {
  double tolerance = BRep_Tool::Tolerance(edge);
  for (TopExp_Explorer ends(edge, TopAbs_VERTEX); ends.More(); ends.Next()) {
    tolerance = std::max(tolerance, BRep_Tool::Tolerance(TopoDS::Vertex(ends.Current())));
  }
  return tolerance;
}

double SizeOf(const std::vector<TopoDS_Face>& faces) {
  Bnd_Box box;
  for (const TopoDS_Face& face : faces) BRepBndLib::Add(face, box, false);
  return box.IsVoid() || box.IsOpen() ? 0 : std::sqrt(box.SquareExtent());
}

std::vector<FaceBorder> BordersOf(const std::vector<BodyFace>& faces) {
  TopTools_IndexedMapOfShape known;
  std::vector<FaceBorder> borders;
  for (const BodyFace& face : faces) {
    FaceBorder& border = borders.emplace_back();
    border.reversed = (face.face.Orientation() == TopAbs_REVERSED) != face.wires.turned;
    const auto& curves = face.wires.curves;
    if (curves.empty()) continue;
    const std::vector<std::vector<TopoDS_Edge>> edges = EdgesOfWires(face.face);
    for (size_t w = 0; w < curves.size(); ++w) {
      auto& loop = border.loops.emplace_back();
      for (size_t k = 0; k < curves[w].size(); ++k) {
        const TopoDS_Edge& edge = edges[w][k];
        const int number = BRep_Tool::Degenerated(edge) ? -1 : known.Add(edge) - 1;
        loop.push_back({curves[w][k], number, edge.Orientation() == TopAbs_REVERSED});
      }
    }
  }
  return borders;
}

}  // namespace

std::vector<EdgeOfFaces> FaceEdges(const std::vector<TopoDS_Face>& faces) {
  TopTools_IndexedMapOfShape known;
  std::vector<EdgeOfFaces> found;
  for (size_t k = 0; k < faces.size(); ++k) {
    for (TopExp_Explorer edges(faces[k], TopAbs_EDGE); edges.More(); edges.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(edges.Current());
      if (BRep_Tool::Degenerated(edge)) continue;
      const auto place = static_cast<size_t>(known.Add(edge)) - 1;
      if (place == found.size()) found.push_back({edge, {}, false});
      EdgeOfFaces& one = found[place];
      if (!one.faces.empty() && one.faces.back() == k) {
        one.seam = true;
      } else {
        one.faces.push_back(k);
      }
    }
  }
  return found;
}

GeometryBody BodyOf(const std::vector<BodyFace>& faces) {
  GeometryBody body;
  std::vector<TopoDS_Face> shapes;
  for (const BodyFace& one : faces) {
    body.surfaces.push_back(one.surface);
    shapes.push_back(one.face);
  }
  body.borders = BordersOf(faces);
  body.tolerance = kLeastTolerance * SizeOf(shapes);
  for (const EdgeOfFaces& one : FaceEdges(shapes)) {
    if (one.faces.size() > 1) {
      ++body.shared_edges;
      body.tolerance = std::max(body.tolerance, ToleranceOf(one.edge));
    } else if (one.free()) {
      body.free_edges.push_back({body.surfaces[one.faces[0]],
                                 Place(TopExp::FirstVertex(one.edge, true)),
                                 Place(TopExp::LastVertex(one.edge, true))});
    }
  }
  if (!std::isfinite(body.tolerance)) body.tolerance = 0;
  return body;
}

}  // namespace batten::internal
