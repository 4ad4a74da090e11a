// SPDX-License-Identifier: MIT
#include "io/opencascade/step_output.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Controller.hxx>
#include <Standard_Failure.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <XSControl_WorkSession.hxx>
#include <locale>
#include <sstream>
#include <utility>

#include "io/base/time_stamp.h"
#include "io/opencascade/occt_convert.h"

namespace batten::internal {
namespace {

void SetHeader(const Handle(StepData_StepModel) & model) {
  APIHeaderSection_MakeHeader header(model);
  header.SetName(internal::Text("batten"));
  header.SetTimeStamp(internal::Text(TimeStamp("%Y-%m-%dT%H:%M:%S")));
  header.SetAuthorValue(1, internal::Text("batten"));
  header.SetOrganizationValue(1, internal::Text(""));
  header.SetPreprocessorVersion(internal::Text("batten"));
  header.SetOriginatingSystem(internal::Text("batten"));
  header.SetAuthorisation(internal::Text(""));
  header.SetDescriptionValue(1, internal::Text("NURBS fitted by batten"));
}

}  // namespace

void BeginStep(const char* unit, const char* schema) {
  STEPControl_Controller::Init();
  Interface_Static::SetCVal("write.step.schema", schema);
  Interface_Static::SetCVal("write.step.unit", unit);
  Interface_Static::SetCVal("xstep.cascade.unit", unit);
  Interface_Static::SetCVal("write.step.product.name", "batten");
}

void NameProducts(STEPControl_Writer& writer, const std::vector<std::string>& names) {
  const Handle(StepData_StepModel) model = writer.Model();
  size_t count = 0;
  for (int k = 1; k <= model->NbEntities(); ++k) {
    const auto product = Handle(StepBasic_Product)::DownCast(model->Value(k));
    if (product.IsNull()) continue;
    std::string name = count < names.size() ? names[count] : "";
    ++count;
    if (name.empty()) name = "batten-" + std::to_string(count);
    product->SetId(internal::Text(name));
    product->SetName(internal::Text(name));
  }
}

std::string StepTextOf(STEPControl_Writer& writer) {
  const Handle(StepData_StepModel) model = writer.Model();
  SetHeader(model);
  StepData_StepWriter text(model);
  text.FloatWriter().SetFormat("%.16E");
  text.FloatWriter().SetZeroSuppress(false);
  text.SendModel(Handle(StepData_Protocol)::DownCast(writer.WS()->Protocol()));
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  if (!text.Print(stream)) throw Standard_Failure("OpenCASCADE does not write the model");
  return std::move(stream).str();
}

}  // namespace batten::internal
