// SPDX-License-Identifier: MIT
#include "io/opencascade/cad_shapes.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <gp_Trsf.hxx>

#include "io/opencascade/sewn_faces.h"

namespace batten::internal {
namespace {

void Scale(ExportPart& part, double factor) {
  gp_Trsf scale;
  scale.SetScale(gp_Pnt(), factor);
  BRepBuilderAPI_Transform scaled(part.shape, scale, true);
  for (auto& [face, name] : part.faces) face = scaled.ModifiedShape(face);
  part.shape = scaled.Shape();
}

std::vector<ExportPart> HeldParts(const CadShapes& shapes, std::optional<SewingReport>& report) {
  std::vector<ExportPart> parts = static_cast<const HeldShapes*>(shapes.held.get())->parts;
  std::vector<SewnFaces::Piece> bodies;
  size_t surfaces = 0, invalid = 0;
  for (ExportPart& part : parts) {
    if (shapes.times != shapes.over) Scale(part, shapes.times / shapes.over);
    const TopAbs_ShapeEnum type = part.shape.ShapeType();
    if (type != TopAbs_SOLID && type != TopAbs_SHELL) continue;
    SewnFaces::Piece& body = bodies.emplace_back(SewnFaces::Piece{part.shape, {}});
    for (TopExp_Explorer each(part.shape, TopAbs_FACE); each.More(); each.Next()) {
      body.faces.emplace_back(TopoDS::Face(each.Current()), surfaces++);
    }
    invalid += !BRepCheck_Analyzer(part.shape).IsValid();
  }
  if (!bodies.empty()) {
    report = ReportOf(bodies);
    report->surfaces = surfaces;
    report->invalid = invalid;
  }
  return parts;
}

}  // namespace

std::vector<BodyMeasures> MeasureShapes(const CadShapes& shapes) {
  const auto& held = *static_cast<const HeldShapes*>(shapes.held.get());
  const double length = shapes.times / shapes.over, area = length * length, volume = area * length;
  constexpr double kPrecision = 1e-10;  // relative, of the integrals over each face
  std::vector<BodyMeasures> all;
  for (const size_t body : held.bodies) {
    GProp_GProps surface, solid;
    BRepGProp::SurfaceProperties(held.parts[body].shape, surface, kPrecision);
    BRepGProp::VolumeProperties(held.parts[body].shape, solid, kPrecision);
    BodyMeasures& one = all.emplace_back();
    one.area = area * surface.Mass();
    one.volume = volume * solid.Mass();
    const gp_Pnt center = solid.CentreOfMass();
    one.center = length * Eigen::Vector3d(center.X(), center.Y(), center.Z());
    const gp_Mat inertia = solid.MatrixOfInertia();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) one.inertia(i, j) = volume * area * inertia(i + 1, j + 1);
    }
  }
  return all;
}

std::vector<ExportPart> PartsToWrite(const GeometryFile& file,
                                     const std::optional<double>& sew,
                                     std::optional<SewingReport>& report) {
  if (file.shapes.held && !sew) return HeldParts(file.shapes, report);
  return ExportParts(file, sew, report);
}

}  // namespace batten::internal
