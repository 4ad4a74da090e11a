// SPDX-License-Identifier: MIT
#include "batten/io/step_units.h"

#include <STEPConstruct_UnitContext.hxx>
#include <StepData_GlobalFactors.hxx>
#include <StepData_StepModel.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>

namespace batten {
namespace {

// The units an entity declares; null when it declares none.
Handle(StepRepr_GlobalUnitAssignedContext) UnitsOf(const Handle(Standard_Transient) & entity) {
  using WithUncertainty = StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx;
  using WithUnits = StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext;
  if (const auto context = Handle(WithUncertainty)::DownCast(entity); !context.IsNull()) {
    return context->GlobalUnitAssignedContext();
  }
  if (const auto context = Handle(WithUnits)::DownCast(entity); !context.IsNull()) {
    return context->GlobalUnitAssignedContext();
  }
  return Handle(StepRepr_GlobalUnitAssignedContext)::DownCast(entity);
}

}  // namespace

void KeepNumbersOf(STEPControl_Reader& reader) {
  StepData_GlobalFactors::Intance().SetCascadeUnit(1);  // millimetres: factors below are absolute
  double millimetres = 1;
  const Handle(StepData_StepModel) model = reader.StepModel();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto declared = UnitsOf(model->Value(i));
    if (declared.IsNull()) continue;
    STEPConstruct_UnitContext units;
    if (units.ComputeFactors(declared) == 0 && units.LengthDone() && units.LengthFactor() > 0) {
      millimetres = units.LengthFactor();
      break;
    }
  }
  reader.SetSystemLengthUnit(millimetres);
}

}  // namespace batten
