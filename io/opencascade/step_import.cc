// SPDX-License-Identifier: MIT
#include "io/opencascade/step_import.h"

#include <STEPControl_Controller.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_UndefinedEntity.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TransferBRep.hxx>
#include <Transfer_Binder.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <istream>
#include <string_view>
#include <utility>

#include "batten/io/read_error.h"
#include "io/exchange/only_lines.h"
#include "io/opencascade/occt_session.h"
#include "io/opencascade/occt_shapes.h"
#include "io/opencascade/step_model.h"
#include "io/opencascade/step_names.h"
#include "io/opencascade/step_units.h"
#include "io/opencascade/text_buffer.h"

namespace batten::internal {
namespace {

// What a file without curves and surfaces holds instead.
std::string WhyEmpty(const Handle(StepData_StepModel) & model) {
  int products = 0, points = 0, meshes = 0;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient) entity = model->Value(i);
    const std::string_view type = entity->DynamicType()->Name();
    products += !Handle(StepBasic_Product)::DownCast(entity).IsNull();
    points += !Handle(StepGeom_CartesianPoint)::DownCast(entity).IsNull();
    const Handle(StepData_UndefinedEntity) unknown =
        Handle(StepData_UndefinedEntity)::DownCast(entity);
    const std::string_view name = unknown.IsNull() ? type : unknown->StepType();
    meshes += name.find("TESSELLATED") != name.npos || name.find("TRIANGULATED") != name.npos ||
              name.find("Tessellated") != name.npos || name.find("Triangulated") != name.npos;
  }
  const std::string none = "holds no curves or surfaces that can be read";
  if (meshes > 0) {
    return none + ", but a mesh: have the CAD program export exact geometry (B-rep)";
  }
  if (points > 0) return none + ", " + std::to_string(points) + " points only";
  if (products > 0) return none + ", only products without a shape";
  return none;
}

// How many parts an assembly places.
int PlacedParts(const Handle(StepData_StepModel) & model) {
  int placed = 0;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    placed += !Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(model->Value(i)).IsNull();
  }
  return placed;
}

// Faces of which no shape was made.
std::vector<std::string> LostFaces(const STEPControl_Reader& reader) {
  const Handle(Transfer_TransientProcess) process =
      reader.WS()->TransferReader()->TransientProcess();
  const Handle(StepData_StepModel) model = reader.StepModel();
  std::vector<std::string> lost;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto face = Handle(StepShape_FaceSurface)::DownCast(model->Value(i));
    if (face.IsNull()) continue;
    const Handle(Transfer_Binder) binder = process->Find(face);
    if (!binder.IsNull() && !TransferBRep::ShapeResult(binder).IsNull()) continue;
    lost.push_back(std::string(model->StringLabel(face)->ToCString()) +
                   ": OpenCASCADE makes no face of it");
  }
  return lost;
}

GeometryContents Translate(std::string& text, const std::string& path) {
  STEPControl_Controller::Init();
  STEPControl_Reader reader;
  TextBuffer buffer(text);
  std::istream stream(&buffer);
  if (reader.ReadStream("batten", stream) != IFSelect_RetDone) {
    throw ReadError(path, "is damaged: it can't be parsed as STEP");
  }
  CheckStepModel(reader.StepModel(), path);
  const StepUnits units = KeepNumbersOf(reader);
  reader.TransferRoots();
  const StepNames names(reader);
  GeometryContents contents;
  contents.unit = units.name;
  contents.remarks = units.remarks;
  ShapeCollector collector(contents,
                           [&names](const TopoDS_Shape& shape) { return names.Of(shape); });
  for (int i = 1; i <= reader.NbShapes(); ++i) collector.Add(reader.Shape(i));
  collector.Finish();
  collector.TellLost(LostFaces(reader));
  RequireGeometry(contents, path, WhyEmpty(reader.StepModel()));
  if (OnlyLines(contents.geometry)) {
    contents.remarks.push_back("it holds only lines: they are curves of degree 1");
  }
  contents.flattened = WhatIsFlattened(contents, PlacedParts(reader.StepModel()));
  return contents;
}

}  // namespace

GeometryContents ImportStep(std::string text, const std::string& name) {
  try {
    const OcctSession session;
    return Translate(text, name);
  } catch (const Standard_Failure& failure) {
    throw ReadError(name, std::string("is damaged: ") + failure.GetMessageString());
  }
}

}  // namespace batten::internal
