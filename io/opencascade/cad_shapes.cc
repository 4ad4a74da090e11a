// SPDX-License-Identifier: MIT
#include "io/opencascade/cad_shapes.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <gp_Trsf.hxx>
#include <stdexcept>

#include "io/opencascade/occt_session.h"
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
  const auto& held = *static_cast<const HeldShapes*>(shapes.held.get());
  std::vector<ExportPart> parts = held.parts;
  for (ExportPart& part : parts) {
    if (shapes.times != shapes.over) Scale(part, shapes.times / shapes.over);
  }
  std::vector<SewnFaces::Piece> bodies;
  size_t surfaces = 0, invalid = 0;
  for (const size_t body : held.bodies) {
    const TopoDS_Shape& shape = parts[body].shape;
    SewnFaces::Piece& piece = bodies.emplace_back(SewnFaces::Piece{shape, {}});
    for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next()) {
      piece.faces.emplace_back(TopoDS::Face(each.Current()), surfaces++);
    }
    invalid += !BRepCheck_Analyzer(shape).IsValid();
  }
  if (!bodies.empty()) {
    report = ReportOf(bodies);
    report->surfaces = surfaces;
    report->invalid = invalid;
  }
  return parts;
}

}  // namespace

std::vector<BodyMeasures> MeasureShapes(const CadShapes& shapes) try {
  const OcctSession session;
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
    one.inside_out = solid.Mass() < 0;
    const double sign = one.inside_out ? -1 : 1;
    one.volume = sign * volume * solid.Mass();
    const gp_Pnt center = solid.CentreOfMass();
    one.center = length * Eigen::Vector3d(center.X(), center.Y(), center.Z());
    const gp_Mat inertia = solid.MatrixOfInertia();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) one.inertia(i, j) = sign * volume * area * inertia(i + 1, j + 1);
    }
  }
  return all;
} catch (const Standard_Failure& failure) {
  throw std::runtime_error(std::string("MeasureBodies: ") + failure.GetMessageString());
}

std::vector<ExportPart> PartsToWrite(const GeometryFile& file,
                                     const std::optional<double>& sew,
                                     std::optional<SewingReport>& report) {
  if (file.shapes.held && !sew) return HeldParts(file.shapes, report);
  return ExportParts(file, sew, report);
}

}  // namespace batten::internal
