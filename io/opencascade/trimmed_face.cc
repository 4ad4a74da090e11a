// SPDX-License-Identifier: MIT
#include "io/opencascade/trimmed_face.h"

#include <BRep_Builder.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "batten/geometry/closure.h"
#include "batten/geometry/direction.h"
#include "batten/geometry/trim_loops.h"
#include "io/exchange/file_loops.h"
#include "io/exchange/trim_pieces.h"
#include "io/opencascade/occt_convert.h"
#include "io/opencascade/space_curve.h"

namespace batten::internal {
namespace {

constexpr double kSamePlace = 1e-9;  // of the domain

class FaceBuilder {
 public:
  explicit FaceBuilder(const NurbsSurface& surface)
      : surface_(surface),
        sides_(DomainSides(surface)),
        collapsed_(CollapsedEdges(surface)),
        closed_u_(Closed(surface, Direction::kU)),
        closed_v_(Closed(surface, Direction::kV)),
        bspline_(ToOcct(surface)) {}

  TopoDS_Shape Build() {
    const std::vector<std::vector<NurbsCurve<2>>> regions = LoopsByRegion(surface_);
    for (const std::vector<NurbsCurve<2>>& region : regions) {
      for (const NurbsCurve<2>& loop : region) loops_.push_back(TrimPieces(surface_, loop));
    }
    if (closed_u_) MatchSides(loops_, Side::kULower, Side::kUUpper);
    if (closed_v_) MatchSides(loops_, Side::kVLower, Side::kVUpper);
    TopoDS_Compound faces;
    builder_.MakeCompound(faces);
    TopoDS_Face face;
    auto loop = loops_.begin();
    for (const std::vector<NurbsCurve<2>>& region : regions) {
      builder_.MakeFace(face, bspline_, Precision::Confusion());
      for (size_t k = 0; k < region.size(); ++k) builder_.Add(face, ToWire(*loop++));
      builder_.Add(faces, face);
    }
    if (regions.size() == 1) return face;
    return faces;
  }

 private:
  // A corner of loops: what is one place of the surface is one vertex.
  struct Corner {
    Eigen::Vector2d place;
    TopoDS_Vertex vertex;
  };
  // An edge on a seam that waits for its other side.
  struct SeamEdge {
    TrimPiece piece;
    TopoDS_Edge edge;
    bool taken = false;
  };

  bool Collapsed(Side side) const {
    return (side == Side::kULower && collapsed_.u_lower) ||
           (side == Side::kUUpper && collapsed_.u_upper) ||
           (side == Side::kVLower && collapsed_.v_lower) ||
           (side == Side::kVUpper && collapsed_.v_upper);
  }
  bool OnSeam(Side side) const {
    return ((side == Side::kULower || side == Side::kUUpper) && closed_u_) ||
           ((side == Side::kVLower || side == Side::kVUpper) && closed_v_);
  }

  // The place that stands for all that are the same point: the lower side of a seam, the start of
  // an edge that is a point.
  Eigen::Vector2d PointStatistics(Eigen::Vector2d place) const {
    const Eigen::Vector2d lower(surface_.basis_u().lower(), surface_.basis_v().lower());
    const Eigen::Vector2d upper(surface_.basis_u().upper(), surface_.basis_v().upper());
    const auto near = [&](int k, double value) {
      return std::abs(place[k] - value) <= kSamePlace * sides_[k];
    };
    if (closed_u_ && near(0, upper[0])) place[0] = lower[0];
    if (closed_v_ && near(1, upper[1])) place[1] = lower[1];
    if ((collapsed_.u_lower && near(0, lower[0])) || (collapsed_.u_upper && near(0, upper[0]))) {
      place[1] = lower[1];
    }
    if ((collapsed_.v_lower && near(1, lower[1])) || (collapsed_.v_upper && near(1, upper[1]))) {
      place[0] = lower[0];
    }
    return place;
  }

  TopoDS_Vertex VertexAt(const Eigen::Vector2d& at) {
    const Eigen::Vector2d place = PointStatistics(at);
    for (const Corner& corner : corners_) {
      const Eigen::Array2d gap = (corner.place - place).array().abs();
      if ((gap <= kSamePlace * sides_).all()) return corner.vertex;
    }
    const gp_Pnt point = bspline_->Value(place[0], place[1]);
    Corner corner = {place, {}};
    builder_.MakeVertex(corner.vertex, point, Precision::Confusion());
    corners_.push_back(corner);
    return corner.vertex;
  }

  void AddEnds(TopoDS_Edge& edge, const NurbsCurve<2>& curve) {
    const SplineBasis& basis = curve.basis();
    builder_.Add(edge, VertexAt(curve.At(basis.lower())).Oriented(TopAbs_FORWARD));
    builder_.Add(edge, VertexAt(curve.At(basis.upper())).Oriented(TopAbs_REVERSED));
  }

  TopoDS_Edge NewEdge(const TrimPiece& piece) {
    const NurbsCurve<2>& curve = piece.curve;
    const Handle(Geom2d_BSplineCurve) parameters = ToOcct2d(curve);
    TopoDS_Edge edge;
    builder_.MakeEdge(edge);
    double tolerance = Precision::Confusion();
    if (Collapsed(piece.side)) {
      builder_.UpdateEdge(edge, parameters, bspline_, TopLoc_Location(), tolerance);
      builder_.Degenerated(edge, true);
    } else {
      const Handle(Geom_BSplineCurve) in_space = CurveInSpace(bspline_, parameters);
      tolerance = std::max(tolerance, 1.1 * Deviation(*in_space, *parameters, *bspline_));
      builder_.UpdateEdge(edge, in_space, tolerance);
      if (OnSeam(piece.side)) {
        AddSeam(edge, piece, parameters, tolerance);
      } else {
        builder_.UpdateEdge(edge, parameters, bspline_, TopLoc_Location(), tolerance);
      }
    }
    AddEnds(edge, curve);
    builder_.Range(edge, curve.basis().lower(), curve.basis().upper());
    builder_.SameRange(edge, true);
    builder_.SameParameter(edge, true);
    return edge;
  }

  // The same curve on either side.
  void AddSeam(TopoDS_Edge& edge,
               const TrimPiece& piece,
               const Handle(Geom2d_BSplineCurve) & parameters,
               double tolerance) {
    if (!HasPartner(piece)) {
      builder_.UpdateEdge(edge, parameters, bspline_, TopLoc_Location(), tolerance);
      return;
    }
    const bool lower = piece.side == Side::kULower || piece.side == Side::kVLower;
    const bool across_u = piece.side == Side::kULower || piece.side == Side::kUUpper;
    const double step = (lower ? 1 : -1) * sides_[across_u ? 0 : 1];
    const Handle(Geom2d_BSplineCurve) other =
        Handle(Geom2d_BSplineCurve)::DownCast(parameters->Copy());
    other->Translate(gp_Vec2d(across_u ? step : 0, across_u ? 0 : step));
    builder_.UpdateEdge(edge, parameters, other, bspline_, TopLoc_Location(), tolerance);
  }

  // Whether two pieces are the same line from both sides of a seam.
  bool Partners(const TrimPiece& a, const TrimPiece& b) const {
    const auto opposite = [](Side x, Side y) {
      return (x == Side::kULower && y == Side::kUUpper) ||
             (x == Side::kVLower && y == Side::kVUpper);
    };
    if (!opposite(a.side, b.side) && !opposite(b.side, a.side)) return false;
    const int along = a.side == Side::kULower || a.side == Side::kUUpper ? 1 : 0;
    const auto end = [&](const NurbsCurve<2>& curve, bool upper) {
      return curve.At(upper ? curve.basis().upper() : curve.basis().lower())[along];
    };
    const double slack = kSamePlace * sides_[along];
    return std::abs(end(a.curve, false) - end(b.curve, true)) <= slack &&
           std::abs(end(a.curve, true) - end(b.curve, false)) <= slack;
  }

  bool HasPartner(const TrimPiece& piece) const {
    for (const auto& loop : loops_) {
      for (const TrimPiece& other : loop) {
        if (Partners(piece, other)) return true;
      }
    }
    return false;
  }

  // The edge of a piece, run through its way.
  TopoDS_Edge ToEdge(const TrimPiece& piece) {
    if (!OnSeam(piece.side) || Collapsed(piece.side)) return NewEdge(piece);
    for (SeamEdge& seam : seams_) {
      if (seam.taken || !Partners(seam.piece, piece)) continue;
      seam.taken = true;
      return TopoDS::Edge(seam.edge.Oriented(TopAbs_REVERSED));
    }
    const TopoDS_Edge edge = NewEdge(piece);
    seams_.push_back({piece, edge});
    return edge;
  }

  TopoDS_Wire ToWire(const std::vector<TrimPiece>& pieces) {
    TopoDS_Wire wire;
    builder_.MakeWire(wire);
    for (const TrimPiece& piece : pieces) builder_.Add(wire, ToEdge(piece));
    wire.Closed(true);
    return wire;
  }

  const NurbsSurface& surface_;
  Eigen::Array2d sides_;
  CollapsedEdgeSet collapsed_;
  bool closed_u_, closed_v_;
  Handle(Geom_BSplineSurface) bspline_;
  BRep_Builder builder_;
  std::vector<std::vector<TrimPiece>> loops_;
  std::vector<Corner> corners_;
  std::vector<SeamEdge> seams_;
};

}  // namespace

TopoDS_Shape ToTrimmedFaces(const NurbsSurface& surface) { return FaceBuilder(surface).Build(); }

}  // namespace batten::internal
