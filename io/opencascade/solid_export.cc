// SPDX-License-Identifier: MIT
#include "io/opencascade/solid_export.h"

#include <BRep_Builder.hxx>
#include <Geom2d_Line.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "batten/io/read_error.h"
#include "io/opencascade/occt_convert.h"
#include "io/opencascade/occt_session.h"
#include "io/opencascade/proved_solid.h"

namespace batten::internal {
namespace {

// Which faces hang together by edges.
std::vector<int> ShellsOf(const SolidModel& solid) {
  std::vector<int> first_face(solid.edges.size(), -1), parent(solid.faces.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int face) {
    while (parent[size_t(face)] != face) face = parent[size_t(face)];
    return face;
  };
  for (int face = 0; face < static_cast<int>(solid.faces.size()); ++face) {
    for (const SolidCoedge& coedge : solid.faces[size_t(face)].loop) {
      int& first = first_face[size_t(coedge.edge)];
      if (first < 0) first = face;
      parent[size_t(root(face))] = root(first);
    }
  }
  std::vector<int> shells;
  for (int face = 0; face < static_cast<int>(parent.size()); ++face) shells.push_back(root(face));
  return shells;
}

class SolidBuilder {
 public:
  explicit SolidBuilder(const SolidModel& solid) : solid_(solid) {
    for (Eigen::Index k = 0; k < solid.vertices.cols(); ++k) {
      const Eigen::Vector3d p = solid.vertices.col(k);
      TopoDS_Vertex vertex;
      builder_.MakeVertex(vertex, gp_Pnt(p.x(), p.y(), p.z()), Precision::Confusion());
      vertices_.push_back(vertex);
    }
    for (const SolidEdge& edge : solid.edges) edges_.push_back(ToEdge(edge));
  }

  // Solids, or an open model's shells.
  Bodies Build() {
    const std::vector<int> shell_of = ShellsOf(solid_);
    std::vector<TopoDS_Shell> shells(solid_.faces.size());
    for (size_t face = 0; face < solid_.faces.size(); ++face) {
      TopoDS_Shell& shell = shells[size_t(shell_of[face])];
      if (shell.IsNull()) builder_.MakeShell(shell);
      builder_.Add(shell, ToFace(solid_.faces[face]));
    }
    const bool open = solid_.open;
    Bodies bodies;
    for (TopoDS_Shell& shell : shells) {
      if (shell.IsNull()) continue;
      shell.Closed(!open);
      if (open) {
        bodies.push_back(shell);
        continue;
      }
      TopoDS_Solid solid;
      builder_.MakeSolid(solid);
      builder_.Add(solid, shell);
      bodies.push_back(solid);
    }
    return bodies;
  }

 private:
  TopoDS_Edge ToEdge(const SolidEdge& edge) {
    TopoDS_Edge made;
    builder_.MakeEdge(made, ToOcct(edge.curve), Precision::Confusion());
    builder_.Add(made, vertices_.at(size_t(edge.start)).Oriented(TopAbs_FORWARD));
    builder_.Add(made, vertices_.at(size_t(edge.end)).Oriented(TopAbs_REVERSED));
    builder_.Range(made, edge.curve.basis().lower(), edge.curve.basis().upper());
    return made;
  }

  TopoDS_Face ToFace(const SolidFace& face) {
    TopoDS_Face made;
    builder_.MakeFace(made, ToOcct(face.surface), Precision::Confusion());
    TopoDS_Wire wire;
    builder_.MakeWire(wire);
    for (const SolidCoedge& coedge : face.loop) {
      const TopoDS_Edge& edge = edges_.at(size_t(coedge.edge));
      const SplineBasis& basis = solid_.edges[size_t(coedge.edge)].curve.basis();
      const Eigen::Vector2d way = coedge.to - coedge.from;
      const double length = basis.upper() - basis.lower();
      // A line's parameter is its length.
      constexpr double kSame = 1e-12;
      if (!(std::abs(way.norm() - length) <= kSame * length)) {
        throw Standard_Failure("an edge and its place on a face run at different speeds");
      }
      const Eigen::Vector2d along = way / length, origin = coedge.from - basis.lower() * along;
      const Handle(Geom2d_Line) line =
          new Geom2d_Line(gp_Pnt2d(origin[0], origin[1]), gp_Dir2d(along[0], along[1]));
      builder_.UpdateEdge(edge, line, made, Precision::Confusion());
      builder_.Add(wire, edge.Oriented(coedge.reversed ? TopAbs_REVERSED : TopAbs_FORWARD));
    }
    wire.Closed(true);
    builder_.Add(made, wire);
    return made;
  }

  const SolidModel& solid_;
  BRep_Builder builder_;
  std::vector<TopoDS_Vertex> vertices_;
  std::vector<TopoDS_Edge> edges_;
};

std::string ToStep(const SolidModel& solid, const char* unit, const char* schema) {
  const double size =
      (solid.vertices.rowwise().maxCoeff() - solid.vertices.rowwise().minCoeff()).norm();
  return ProvedStep(SolidBuilder(solid).Build(), size, unit, schema).text;
}

}  // namespace

std::string ExportSolid(const SolidModel& solid,
                        const std::string& path,
                        const char* unit,
                        const char* schema) {
  try {
    const OcctSession session;
    return ToStep(solid, unit, schema);
  } catch (const Standard_Failure& failure) {
    throw WriteError(path, std::string("can't become a solid: ") + failure.GetMessageString());
  }
}

}  // namespace batten::internal
