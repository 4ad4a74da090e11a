// SPDX-License-Identifier: MIT
#include "io/opencascade/sewn_faces.h"

#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepGProp.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Surface.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <cmath>

#include "io/opencascade/body_edges.h"
#include "io/opencascade/edge_gaps.h"

namespace batten::internal {
namespace {

using Piece = SewnFaces::Piece;

std::vector<TopoDS_Face> FacesOf(const Piece& piece) {
  std::vector<TopoDS_Face> faces;
  for (const auto& face : piece.faces) faces.push_back(face.first);
  return faces;
}

bool Closed(const Piece& piece) {
  const std::vector<EdgeOfFaces> edges = FaceEdges(FacesOf(piece));
  return std::all_of(edges.begin(), edges.end(), [](const EdgeOfFaces& one) {
    return one.seam ? one.faces.size() == 1 : one.faces.size() == 2;
  });
}

// A shell of the faces as they are oriented.
TopoDS_Shell ShellOf(const Piece& piece) {
  if (piece.shape.ShapeType() == TopAbs_SHELL) return TopoDS::Shell(piece.shape);
  TopoDS_Shell shell;
  const BRep_Builder builder;
  builder.MakeShell(shell);
  for (const auto& face : piece.faces) builder.Add(shell, face.first);
  return shell;
}

TopoDS_Solid SolidOf(TopoDS_Shell shell) {
  shell.Closed(true);
  TopoDS_Solid solid;
  const BRep_Builder builder;
  builder.MakeSolid(solid);
  builder.Add(solid, shell);
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

double VolumeOf(const TopoDS_Shape& solid) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(solid, properties);
  return std::abs(properties.Mass());
}

bool Inside(const TopoDS_Solid& outer, const TopoDS_Shape& inner, double tolerance) {
  BRepClass3d_SolidClassifier classifier(outer);
  TopExp_Explorer corners(inner, TopAbs_VERTEX);
  if (!corners.More()) return false;
  classifier.Perform(BRep_Tool::Pnt(TopoDS::Vertex(corners.Current())), tolerance);
  return classifier.State() == TopAbs_IN;
}

// The closed shells of one solid: those in the largest one are its voids.
void MakeVoids(std::vector<Piece>& pieces, double tolerance) {
  const bool solids = std::all_of(pieces.begin(), pieces.end(), [](const Piece& piece) {
    return piece.shape.ShapeType() == TopAbs_SOLID;
  });
  if (pieces.size() < 2 || !solids) return;
  const auto largest =
      std::max_element(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) {
        return VolumeOf(a.shape) < VolumeOf(b.shape);
      });
  std::iter_swap(pieces.begin(), largest);
  const TopoDS_Solid outer = TopoDS::Solid(pieces[0].shape);
  for (size_t k = 1; k < pieces.size(); ++k) {
    if (!Inside(outer, pieces[k].shape, tolerance)) return;
  }
  TopoDS_Solid whole;
  const BRep_Builder builder;
  builder.MakeSolid(whole);
  builder.Add(whole, TopExp_Explorer(outer, TopAbs_SHELL).Current());
  for (size_t k = 1; k < pieces.size(); ++k) {
    builder.Add(whole, TopExp_Explorer(pieces[k].shape, TopAbs_SHELL).Current().Reversed());
    pieces[0].faces.insert(pieces[0].faces.end(), pieces[k].faces.begin(), pieces[k].faces.end());
  }
  pieces[0].shape = whole;
  pieces.resize(1);
}

// What sewing gives: shells, then faces outside them.
std::vector<Piece> Sewn(const std::vector<TopoDS_Face>& faces, double tolerance) {
  BRepBuilderAPI_Sewing sewing(tolerance);
  for (const TopoDS_Face& face : faces) sewing.Add(face);
  sewing.Perform();
  std::vector<TopoDS_Shape> become;
  for (const TopoDS_Face& face : faces) {
    become.push_back(sewing.IsModified(face) ? sewing.Modified(face) : face);
  }
  const auto piece_of = [&](const TopoDS_Shape& shape) {
    Piece piece{shape, {}};
    for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next()) {
      const auto from = std::find_if(become.begin(), become.end(), [&](const TopoDS_Shape& one) {
        return one.IsSame(each.Current());
      });
      if (from == become.end()) continue;  // of no face there is: then all are left apart
      piece.faces.emplace_back(TopoDS::Face(each.Current()),
                               static_cast<size_t>(from - become.begin()));
    }
    return piece;
  };
  std::vector<Piece> pieces;
  const TopoDS_Shape& result = sewing.SewedShape();
  if (result.IsNull()) return pieces;
  for (TopExp_Explorer each(result, TopAbs_SHELL); each.More(); each.Next()) {
    pieces.push_back(piece_of(each.Current()));
  }
  for (TopExp_Explorer each(result, TopAbs_FACE, TopAbs_SHELL); each.More(); each.Next()) {
    pieces.push_back(piece_of(each.Current()));
  }
  return pieces;
}

std::vector<Piece> Apart(const std::vector<TopoDS_Face>& faces) {
  std::vector<Piece> pieces;
  for (size_t k = 0; k < faces.size(); ++k) pieces.push_back({faces[k], {{faces[k], k}}});
  return pieces;
}

bool Complete(const std::vector<Piece>& pieces, size_t faces) {
  size_t count = 0;
  for (const Piece& piece : pieces) count += piece.faces.size();
  return count == faces;
}

// Takes pieces that are no valid shapes apart again, and returns how many faces that were.
size_t LeaveInvalid(std::vector<Piece>& pieces, const std::vector<TopoDS_Face>& faces) {
  std::vector<Piece> valid;
  size_t count = 0;
  for (Piece& piece : pieces) {
    if (piece.faces.size() == 1 || BRepCheck_Analyzer(piece.shape).IsValid()) {
      valid.push_back(std::move(piece));
      continue;
    }
    for (const auto& face : piece.faces) {
      valid.push_back({faces[face.second], {{faces[face.second], face.second}}});
      ++count;
    }
  }
  pieces = std::move(valid);
  return count;
}

}  // namespace

SewingReport ReportOf(const std::vector<Piece>& pieces) {
  SewingReport report;
  std::vector<TopoDS_Edge> free;
  for (const Piece& piece : pieces) {
    report.solids += piece.shape.ShapeType() == TopAbs_SOLID;
    report.shells += piece.shape.ShapeType() == TopAbs_SHELL;
    report.loose += piece.shape.ShapeType() == TopAbs_FACE;
    const std::vector<TopoDS_Face> faces = FacesOf(piece);
    for (const EdgeOfFaces& one : FaceEdges(faces)) {
      if (one.free()) free.push_back(one.edge);
      if (one.faces.size() < 2) continue;
      ++report.shared_edges;
      for (size_t k = 1; k < one.faces.size(); ++k) {
        report.largest_gap = std::max(report.largest_gap,
                                      GapAlong(one.edge, faces[one.faces[0]], faces[one.faces[k]]));
      }
    }
  }
  report.free_edges = free.size();
  report.nearest_gap = NearestGap(free);
  return report;
}

SewnFaces SewFaces(const std::vector<TopoDS_Face>& faces, double tolerance, bool solid) {
  SewnFaces sewn{Sewn(faces, tolerance), {}};
  for (Piece& piece : sewn.pieces) {
    if (Closed(piece)) piece.shape = SolidOf(ShellOf(piece));
  }
  if (solid) MakeVoids(sewn.pieces, tolerance);
  if (!Complete(sewn.pieces, faces.size())) sewn.pieces = Apart(faces);
  const size_t invalid = LeaveInvalid(sewn.pieces, faces);
  sewn.report = ReportOf(sewn.pieces);
  sewn.report.invalid = invalid;
  return sewn;
}

}  // namespace batten::internal
