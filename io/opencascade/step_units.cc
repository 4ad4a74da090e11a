// SPDX-License-Identifier: MIT
#include "io/opencascade/step_units.h"

#include <STEPConstruct_UnitContext.hxx>
#include <StepBasic_ConversionBasedUnitAndLengthUnit.hxx>
#include <StepData_GlobalFactors.hxx>
#include <StepData_StepModel.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <TCollection_HAsciiString.hxx>
#include <algorithm>
#include <cmath>

#include "batten/io/length_unit.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
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

// Of every context that declares one, in millimetres, each once.
std::vector<double> DeclaredFactors(const Handle(StepData_StepModel) & model) {
  constexpr double kSame = 1e-9;
  constexpr size_t kMost = 16;  // more are not worth telling apart
  std::vector<double> factors;
  const auto note = [&](double factor) {
    const bool known = std::any_of(factors.begin(), factors.end(), [&](double other) {
      return std::abs(other - factor) <= kSame * other;
    });
    if (factor > 0 && std::isfinite(factor) && !known) factors.push_back(factor);
  };
  for (int i = 1; i <= model->NbEntities() && factors.size() < kMost; ++i) {
    const auto declared = UnitsOf(model->Value(i));
    if (declared.IsNull()) continue;
    STEPConstruct_UnitContext units;
    if (units.ComputeFactors(declared) == 0 && units.LengthDone()) note(units.LengthFactor());
    // A context may name two.
    for (int k = 1; k <= declared->NbUnits(); ++k) {
      STEPConstruct_UnitContext one;
      if (one.ComputeFactors(declared->UnitsValue(k)) == 0 && one.LengthDone()) {
        note(one.LengthFactor());
      }
    }
  }
  return factors;
}

// A unit by its name, or else its length in millimetres.
std::string Called(double factor) {
  const std::string name = LengthUnitName(factor);
  return name.empty() ? NumberText(factor) + " mm" : name;
}

// Units that are called one thing and are as long as another.
void RemarkMisnamed(const Handle(StepData_StepModel) & model, std::vector<std::string>& remarks) {
  static constexpr struct {
    const char* name;
    double millimetres;
  } kNames[] = {{"INCH", 25.4},
                {"INCHES", 25.4},
                {"FOOT", 304.8},
                {"FEET", 304.8},
                {"MILLIMETRE", 1},
                {"MILLIMETER", 1},
                {"CENTIMETRE", 10},
                {"CENTIMETER", 10},
                {"METRE", 1000},
                {"METER", 1000},
                {"MIL", 0.0254},
                {"MILE", 1609344}};
  constexpr double kSame = 1e-3;  // survey feet and rounded inches are meant
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto unit = Handle(StepBasic_ConversionBasedUnitAndLengthUnit)::DownCast(model->Value(i));
    if (unit.IsNull() || unit->Name().IsNull()) continue;
    TCollection_AsciiString name = unit->Name()->String();
    name.UpperCase();
    STEPConstruct_UnitContext units;
    if (units.ComputeFactors(unit) != 0 || !units.LengthDone()) continue;
    for (const auto& known : kNames) {
      if (name != known.name) continue;
      if (std::abs(units.LengthFactor() - known.millimetres) <= kSame * known.millimetres) continue;
      remarks.push_back(std::string("its unit called ") + name.ToCString() + " is " +
                        NumberText(units.LengthFactor()) + " mm long: that length is taken");
    }
  }
}

}  // namespace

StepUnits KeepNumbersOf(STEPControl_Reader& reader) {
  StepData_GlobalFactors::Intance().SetCascadeUnit(1);  // millimetres: factors below are absolute
  const Handle(StepData_StepModel) model = reader.StepModel();
  const std::vector<double> factors = DeclaredFactors(model);
  StepUnits units;
  if (factors.empty()) {
    units.remarks.push_back("it declares no unit of length");
    reader.SetSystemLengthUnit(1);
    return units;
  }
  units.name = LengthUnitName(factors[0]);
  const bool known = !units.name.empty();
  if (!known) {
    units.name = "mm";
    units.remarks.push_back("its unit of " + Called(factors[0]) + " has no name: turned into mm");
  }
  if (factors.size() > 1) {
    std::string all;
    for (const double factor : factors) all += (all.empty() ? "" : ", ") + Called(factor);
    units.remarks.push_back("it declares several units (" + all + "): all is turned into " +
                            units.name);
  }
  RemarkMisnamed(model, units.remarks);
  reader.SetSystemLengthUnit(known ? factors[0] : 1);
  return units;
}

}  // namespace batten::internal
