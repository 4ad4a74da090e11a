// SPDX-License-Identifier: MIT
#include "io/opencascade/trimmed_solid_export.h"

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Precision.hxx>
#include <ShapeFix_Shape.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <variant>
#include <vector>

#include "batten/io/read_error.h"
#include "io/opencascade/occt_convert.h"
#include "io/opencascade/occt_session.h"
#include "io/opencascade/proved_solid.h"

namespace batten::internal {
namespace {

gp_Pnt PointOf(const Eigen::Vector3d& p) { return gp_Pnt(p.x(), p.y(), p.z()); }
gp_Dir DirectionOf(const Eigen::Vector3d& d) { return gp_Dir(d.x(), d.y(), d.z()); }

// Analytic surfaces whose natural normals look away from axis or centre.
struct CarrierOf {
  Eigen::Vector3d near;  // a point of the face

  Handle(Geom_Surface) operator()(const PlaneShape& s) const {
    return new Geom_Plane(PointOf(s.point), DirectionOf(s.normal));
  }
  Handle(Geom_Surface) operator()(const CylinderShape& s) const {
    return new Geom_CylindricalSurface(gp_Ax3(PointOf(s.point), DirectionOf(s.axis)), s.radius);
  }
  Handle(Geom_Surface) operator()(const SphereShape& s) const {
    return new Geom_SphericalSurface(gp_Ax3(PointOf(s.center), gp::DZ()), s.radius);
  }
  Handle(Geom_Surface) operator()(const ConeShape& s) const {
    const double height = std::max(std::abs((near - s.apex).dot(s.axis)), Precision::Confusion());
    return new Geom_ConicalSurface(gp_Ax3(PointOf(s.apex + height * s.axis), DirectionOf(s.axis)),
                                   s.half_angle,
                                   height * std::tan(s.half_angle));
  }
  Handle(Geom_Surface) operator()(const TorusShape& s) const {
    return new Geom_ToroidalSurface(
        gp_Ax3(PointOf(s.center), DirectionOf(s.axis)), s.major_radius, s.minor_radius);
  }
  template <typename Other>
  Handle(Geom_Surface) operator()(const Other&) const {
    throw Standard_Failure("a face of the solid is on no plane, cylinder, cone, sphere or torus");
  }
};

// Which faces hang together by edges.
std::vector<int> ShellsOf(const TrimmedSolid& solid) {
  std::vector<int> first_face(solid.edges.size(), -1), parent(solid.faces.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int face) {
    while (parent[size_t(face)] != face) face = parent[size_t(face)];
    return face;
  };
  for (int face = 0; face < static_cast<int>(solid.faces.size()); ++face) {
    for (const auto& loop : solid.faces[size_t(face)].loops) {
      for (const TrimmedSolidCoedge& coedge : loop) {
        int& first = first_face[size_t(coedge.edge)];
        if (first < 0) first = face;
        parent[size_t(root(face))] = root(first);
      }
    }
  }
  std::vector<int> shells;
  for (int face = 0; face < static_cast<int>(parent.size()); ++face) shells.push_back(root(face));
  return shells;
}

class TrimmedSolidBuilder {
 public:
  explicit TrimmedSolidBuilder(const TrimmedSolid& solid) : solid_(solid) {
    for (const auto& p : solid.vertices.colwise()) {
      TopoDS_Vertex vertex;
      builder_.MakeVertex(vertex, PointOf(p), Precision::Confusion());
      vertices_.push_back(vertex);
    }
    for (const TrimmedSolidEdge& edge : solid.edges) edges_.push_back(ToEdge(edge));
  }

  Bodies Build() {
    const std::vector<int> shell_of = ShellsOf(solid_);
    std::vector<TopoDS_Shell> shells(solid_.faces.size());
    for (size_t face = 0; face < solid_.faces.size(); ++face) {
      TopoDS_Shell& shell = shells[size_t(shell_of[face])];
      if (shell.IsNull()) builder_.MakeShell(shell);
      builder_.Add(shell, ToFace(solid_.faces[face]));
    }
    Bodies solids;
    for (const TopoDS_Shell& shell : shells) {
      if (shell.IsNull()) continue;
      TopoDS_Solid solid;
      builder_.MakeSolid(solid);
      builder_.Add(solid, shell);
      solids.push_back(Fixed(solid));
    }
    return solids;
  }

 private:
  TopoDS_Edge ToEdge(const TrimmedSolidEdge& edge) {
    Handle(Geom_Curve) curve;
    double first = edge.curve.basis().lower(), last = edge.curve.basis().upper();
    if (edge.exact && std::holds_alternative<ExactLine>(*edge.exact)) {
      const ExactLine& line = std::get<ExactLine>(*edge.exact);
      curve = new Geom_Line(PointOf(line.start), DirectionOf((line.end - line.start).normalized()));
      first = 0;
      last = (line.end - line.start).norm();
    } else if (edge.exact) {
      const ExactArc& arc = std::get<ExactArc>(*edge.exact);
      curve = new Geom_Circle(gp_Ax2(PointOf(arc.frame.origin()),
                                     DirectionOf(arc.frame.axis()),
                                     DirectionOf(arc.frame.x())),
                              arc.radius);
      first = arc.angles.start;
      last = arc.angles.start + arc.angles.sweep;
    } else {
      curve = ToOcct(edge.curve);
    }
    TopoDS_Edge made;
    builder_.MakeEdge(made, curve, Precision::Confusion());
    builder_.Add(made, vertices_.at(size_t(edge.start)).Oriented(TopAbs_FORWARD));
    builder_.Add(made, vertices_.at(size_t(edge.end)).Oriented(TopAbs_REVERSED));
    builder_.Range(made, first, last);
    return made;
  }

  // Loops run with the face on their left seen from outside; on a reversed face that is on their
  // right seen against the natural normal.
  TopoDS_Face ToFace(const TrimmedSolidFace& face) {
    const Eigen::Vector3d near =
        face.loops.empty()
            ? Eigen::Vector3d::Zero().eval()
            : solid_.edges[size_t(face.loops[0][0].edge)].curve.control_points().col(0).eval();
    const Handle(Geom_Surface) surface = std::visit(CarrierOf{near}, face.carrier);
    if (face.loops.empty()) {
      TopoDS_Face whole = BRepBuilderAPI_MakeFace(surface, Precision::Confusion());
      return TopoDS::Face(whole.Oriented(face.reversed ? TopAbs_REVERSED : TopAbs_FORWARD));
    }
    TopoDS_Face made;
    builder_.MakeFace(made, surface, Precision::Confusion());
    for (const auto& loop : face.loops) {
      TopoDS_Wire wire;
      builder_.MakeWire(wire);
      const auto add = [&](const TrimmedSolidCoedge& coedge) {
        const bool reversed = coedge.reversed != face.reversed;
        const TopoDS_Edge& edge = edges_.at(size_t(coedge.edge));
        builder_.Add(wire, edge.Oriented(reversed ? TopAbs_REVERSED : TopAbs_FORWARD));
      };
      if (face.reversed) {
        std::for_each(loop.rbegin(), loop.rend(), add);
      } else {
        std::for_each(loop.begin(), loop.end(), add);
      }
      wire.Closed(true);
      builder_.Add(made, wire);
    }
    return TopoDS::Face(made.Oriented(face.reversed ? TopAbs_REVERSED : TopAbs_FORWARD));
  }

  // With the edges' places on their faces, seams and poles.
  static TopoDS_Solid Fixed(const TopoDS_Solid& solid) {
    ShapeFix_Shape fix(solid);
    fix.SetPrecision(Precision::Confusion());
    fix.Perform();
    TopExp_Explorer found(fix.Shape(), TopAbs_SOLID);
    if (!found.More()) throw Standard_Failure("OpenCASCADE makes no solid of the faces");
    TopoDS_Solid fixed = TopoDS::Solid(found.Current());
    BRepLib::SameParameter(fixed, Precision::Confusion());
    return fixed;
  }

  const TrimmedSolid& solid_;
  BRep_Builder builder_;
  std::vector<TopoDS_Vertex> vertices_;
  std::vector<TopoDS_Edge> edges_;
};

}  // namespace

std::string ExportTrimmedSolid(const TrimmedSolid& solid,
                               const std::string& path,
                               const char* unit,
                               const char* schema,
                               SolidCensus& census) {
  try {
    const OcctSession session;
    const double size =
        solid.vertices.cols() < 2
            ? 0
            : (solid.vertices.rowwise().maxCoeff() - solid.vertices.rowwise().minCoeff()).norm();
    ProvedSolid proved = ProvedStep(TrimmedSolidBuilder(solid).Build(), size, unit, schema);
    census = proved.census;
    if (census.faces != static_cast<int>(solid.faces.size())) {
      throw Standard_Failure("OpenCASCADE cuts a face in two");
    }
    return std::move(proved.text);
  } catch (const Standard_Failure& failure) {
    throw WriteError(path, std::string("can't become a solid: ") + failure.GetMessageString());
  }
}

}  // namespace batten::internal
