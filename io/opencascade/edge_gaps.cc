// SPDX-License-Identifier: MIT
#include "io/opencascade/edge_gaps.h"

#include <BRepBndLib.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Geom2d_Curve.hxx>
#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <algorithm>
#include <cmath>
#include <limits>

namespace batten::internal {
namespace {

constexpr int kPlacesOfGap = 32, kPlacesOfEdge = 4;
constexpr size_t kMostEdges = 400;  // each is held against every other one

// An edge's curve with its ends.
struct FreeCurve {
  Handle(Geom_Curve) curve;
  double first = 0, last = 0;
  Bnd_Box box;
};

gp_Pnt At(const FreeCurve& piece, double share) {
  return piece.curve->Value(piece.first + share * (piece.last - piece.first));
}

double Distance(const gp_Pnt& point, const FreeCurve& piece) {
  double distance = std::min(point.Distance(At(piece, 0)), point.Distance(At(piece, 1)));
  const GeomAPI_ProjectPointOnCurve feet(point, piece.curve, piece.first, piece.last);
  if (feet.NbPoints() > 0) distance = std::min(distance, feet.LowerDistance());
  return distance;
}

}  // namespace

double GapAlong(const TopoDS_Edge& edge, const TopoDS_Face& first, const TopoDS_Face& second) {
  double begin = 0, end = 0, gap = 0;
  const Handle(Geom2d_Curve) curves[] = {BRep_Tool::CurveOnSurface(edge, first, begin, end),
                                         BRep_Tool::CurveOnSurface(edge, second, begin, end)};
  const Handle(Geom_Surface) surfaces[] = {BRep_Tool::Surface(first), BRep_Tool::Surface(second)};
  if (curves[0].IsNull() || curves[1].IsNull()) return 0;
  for (int i = 0; i <= kPlacesOfGap; ++i) {
    const double at = begin + (end - begin) * i / kPlacesOfGap;
    gp_Pnt points[2];
    for (int k = 0; k < 2; ++k) {
      const gp_Pnt2d place = curves[k]->Value(at);
      points[k] = surfaces[k]->Value(place.X(), place.Y());
    }
    gap = std::max(gap, points[0].Distance(points[1]));
  }
  return gap;
}

std::optional<double> NearestGap(const std::vector<TopoDS_Edge>& edges) {
  std::vector<FreeCurve> curves;
  for (const TopoDS_Edge& edge : edges) {
    if (curves.size() == kMostEdges) break;
    FreeCurve piece;
    piece.curve = BRep_Tool::Curve(edge, piece.first, piece.last);
    if (piece.curve.IsNull()) continue;
    BRepBndLib::Add(edge, piece.box, false);
    curves.push_back(std::move(piece));
  }
  if (curves.size() < 2) return std::nullopt;
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < curves.size(); ++i) {
    for (size_t j = 0; j < curves.size(); ++j) {
      if (i == j || curves[i].box.Distance(curves[j].box) >= nearest) continue;
      double gap = 0;
      for (int k = 0; k <= kPlacesOfEdge && gap < nearest; ++k) {
        gap = std::max(gap, Distance(At(curves[i], 1.0 * k / kPlacesOfEdge), curves[j]));
      }
      nearest = std::min(nearest, gap);
    }
  }
  return nearest;
}

}  // namespace batten::internal
