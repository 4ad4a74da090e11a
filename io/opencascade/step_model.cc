// SPDX-License-Identifier: MIT
#include "io/opencascade/step_model.h"

#include <Interface_Check.hxx>
#include <Interface_ReportEntity.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <StepGeom_Curve.hxx>
#include <StepGeom_Pcurve.hxx>
#include <StepRepr_DefinitionalRepresentation.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_VertexPoint.hxx>
#include <string_view>

#include "batten/io/read_error.h"

namespace batten::internal {
namespace {

// The first failure of a check; empty where there is none. What is said in words, and left out by
// `$`, has no part in the shape.
std::string FailureOf(const Handle(Interface_Check) & check) {
  for (int fail = 1; fail <= check->NbFails(); ++fail) {
    const std::string_view words = check->CFail(fail);
    if (words.find("(description) not a quoted String") == words.npos) return std::string(words);
  }
  return "";
}

// Why OpenCASCADE could not fill the entity; empty when it could.
std::string Damage(const Handle(StepData_StepModel) & model, int index) {
  const std::string_view type = model->Value(index)->DynamicType()->Name();
  if (type.substr(0, 10) == "StepVisual" || !model->IsReportEntity(index)) return "";
  const Handle(Interface_ReportEntity) report = model->ReportEntity(index);
  if (!report->IsError()) return "";
  const Handle(Interface_Check) check = report->Check();
  return check->NbFails() == 0 ? "it can't be read" : FailureOf(check);
}

// Whether the entity is a curve on a surface that names no curve, which the translator does not
// expect.
bool LacksItsCurve(const Handle(Standard_Transient) & entity) {
  const auto pcurve = Handle(StepGeom_Pcurve)::DownCast(entity);
  if (pcurve.IsNull()) return false;
  const auto reference = pcurve->ReferenceToCurve();
  return reference.IsNull() || reference->Items().IsNull() || reference->NbItems() < 1 ||
         Handle(StepGeom_Curve)::DownCast(reference->ItemsValue(1)).IsNull();
}

// Whether the entity is a vertex at anything but a point in space, which the translator does not
// expect either.
bool LacksItsPoint(const Handle(Standard_Transient) & entity) {
  const auto vertex = Handle(StepShape_VertexPoint)::DownCast(entity);
  if (vertex.IsNull()) return false;
  const auto point = Handle(StepGeom_CartesianPoint)::DownCast(vertex->VertexGeometry());
  return point.IsNull() || point->NbCoordinates() != 3;
}

}  // namespace

void CheckStepModel(const Handle(StepData_StepModel) & model, const std::string& path) {
  const std::string failure = FailureOf(model->GlobalCheck());
  if (!failure.empty()) throw ReadError(path, "is damaged: " + failure);
  for (int i = 1; i <= model->NbEntities(); ++i) {
    std::string damage = Damage(model, i);
    if (damage.empty() && LacksItsCurve(model->Value(i))) damage = "it does not name a curve";
    if (damage.empty() && LacksItsPoint(model->Value(i))) {
      damage = "a vertex needs a point of three coordinates";
    }
    if (damage.empty()) continue;
    const std::string name = "#" + std::to_string(model->IdentLabel(model->Value(i)));
    throw ReadError(path, "entity " + name + " is damaged: " + damage);
  }
}

}  // namespace batten::internal
