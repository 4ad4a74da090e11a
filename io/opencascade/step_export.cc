// SPDX-License-Identifier: MIT
#include "io/opencascade/step_export.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <Interface_Static.hxx>
#include <STEPConstruct.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopoDS_Shape.hxx>
#include <Transfer_FinderProcess.hxx>
#include <XSControl_TransferWriter.hxx>
#include <XSControl_WorkSession.hxx>
#include <locale>
#include <sstream>
#include <utility>
#include <vector>

#include "batten/io/read_error.h"
#include "io/base/time_stamp.h"
#include "io/opencascade/export_parts.h"
#include "io/opencascade/occt_convert.h"
#include "io/opencascade/occt_session.h"

namespace batten::internal {
namespace {

void SetHeader(const Handle(StepData_StepModel) & model) {
  APIHeaderSection_MakeHeader header(model);
  header.SetName(Text("batten"));
  header.SetTimeStamp(Text(TimeStamp("%Y-%m-%dT%H:%M:%S")));
  header.SetAuthorValue(1, Text("batten"));
  header.SetOrganizationValue(1, Text(""));
  header.SetPreprocessorVersion(Text("batten"));
  header.SetOriginatingSystem(Text("batten"));
  header.SetAuthorisation(Text(""));
  header.SetDescriptionValue(1, Text("NURBS fitted by batten"));
}

// "batten-1", "batten-2", … where there is no name: OpenCASCADE's own count the products of the
// whole process.
void NameProducts(const Handle(StepData_StepModel) & model, const std::vector<ExportPart>& parts) {
  size_t count = 0;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto product = Handle(StepBasic_Product)::DownCast(model->Value(i));
    if (product.IsNull()) continue;
    std::string name = count < parts.size() ? parts[count].name : "";
    ++count;
    if (name.empty()) name = "batten-" + std::to_string(count);
    product->SetId(Text(name));
    product->SetName(Text(name));
  }
}

// Gives the name to the entity of a shape, which of an edge is that of its curve.
void NameItem(const STEPControl_Writer& writer,
              const TopoDS_Shape& shape,
              const std::string& name) {
  if (name.empty()) return;
  const auto process = writer.WS()->TransferWriter()->FinderProcess();
  const auto item = STEPConstruct::FindEntity(process, shape);
  if (!item.IsNull()) item->SetName(Text(name));
}

std::string ToStep(const std::vector<ExportPart>& parts, const char* unit, const char* schema) {
  STEPControl_Controller::Init();
  Interface_Static::SetCVal("write.step.schema", schema);
  Interface_Static::SetCVal("write.step.unit", unit);
  Interface_Static::SetCVal("xstep.cascade.unit", unit);
  Interface_Static::SetCVal("write.step.product.name", "batten");
  STEPControl_Writer writer;
  for (const ExportPart& part : parts) {
    // The graph of the whole model, made anew for each shape, would take quadratic time.
    const bool graph = &part == &parts.back();
    if (writer.Transfer(part.shape, STEPControl_AsIs, graph) != IFSelect_RetDone) {
      throw Standard_Failure("OpenCASCADE does not translate the shape to STEP");
    }
    NameItem(writer, part.shape, part.name);
    for (const auto& [face, name] : part.faces) NameItem(writer, face, name);
  }
  const Handle(StepData_StepModel) model = writer.Model();
  SetHeader(model);
  NameProducts(model, parts);
  StepData_StepWriter text(model);
  text.FloatWriter().SetFormat("%.16E");
  text.FloatWriter().SetZeroSuppress(false);
  text.SendModel(Handle(StepData_Protocol)::DownCast(writer.WS()->Protocol()));
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  if (!text.Print(stream)) throw Standard_Failure("OpenCASCADE does not write the model");
  return std::move(stream).str();
}

}  // namespace

std::string ExportStep(const GeometryFile& file,
                       const char* unit,
                       const char* schema,
                       const std::optional<double>& sew,
                       std::optional<SewingReport>& report) {
  try {
    const OcctSession session;
    return ToStep(ExportParts(file, sew, report), unit, schema);
  } catch (const Standard_Failure& failure) {
    throw WriteError(file.path, std::string("can't become STEP: ") + failure.GetMessageString());
  }
}

}  // namespace batten::internal
