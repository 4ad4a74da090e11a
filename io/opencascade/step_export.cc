// SPDX-License-Identifier: MIT
#include "io/opencascade/step_export.h"

#include <STEPConstruct.hxx>
#include <STEPControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopoDS_Shape.hxx>
#include <Transfer_FinderProcess.hxx>
#include <XSControl_TransferWriter.hxx>
#include <XSControl_WorkSession.hxx>
#include <utility>
#include <vector>

#include "batten/io/read_error.h"
#include "io/opencascade/cad_shapes.h"
#include "io/opencascade/occt_convert.h"
#include "io/opencascade/occt_session.h"
#include "io/opencascade/step_output.h"

namespace batten::internal {
namespace {

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
  BeginStep(unit, schema);
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
  std::vector<std::string> names;
  for (const ExportPart& part : parts) names.push_back(part.name);
  NameProducts(writer, names);
  return StepTextOf(writer);
}

}  // namespace

std::string ExportStep(const GeometryFile& file,
                       const char* unit,
                       const char* schema,
                       const std::optional<double>& sew,
                       std::optional<SewingReport>& report) {
  try {
    const OcctSession session;
    return ToStep(PartsToWrite(file, sew, report), unit, schema);
  } catch (const Standard_Failure& failure) {
    throw WriteError(file.path, std::string("can't become STEP: ") + failure.GetMessageString());
  }
}

}  // namespace batten::internal
