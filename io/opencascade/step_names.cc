// SPDX-License-Identifier: MIT
#include "io/opencascade/step_names.h"

#include <StepBasic_Product.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepBasic_ProductDefinitionFormation.hxx>
#include <StepGeom_Curve.hxx>
#include <StepGeom_Surface.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_EdgeCurve.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <string_view>
#include <utility>

#include "io/exchange/geometry_names.h"

namespace batten::internal {
namespace {

// Empty for what stands for no name.
std::string Text(const Handle(TCollection_HAsciiString) & text) {
  if (text.IsNull()) return "";
  const std::string name = CleanName(text->ToCString());
  return name == "NONE" ? "" : name;
}

std::string NameOfItem(const Handle(StepRepr_RepresentationItem) & item) {
  return item.IsNull() ? "" : Text(item->Name());
}

// The name of what a face or edge lies on.
std::string NameOfGeometry(const Handle(StepRepr_RepresentationItem) & item) {
  if (const auto face = Handle(StepShape_FaceSurface)::DownCast(item); !face.IsNull()) {
    return NameOfItem(face->FaceGeometry());
  }
  if (const auto edge = Handle(StepShape_EdgeCurve)::DownCast(item); !edge.IsNull()) {
    return NameOfItem(edge->EdgeGeometry());
  }
  return "";
}

// Whether it is what batten calls a product without a name: batten-1, batten-2, …
bool IsNumber(const std::string& name) {
  constexpr std::string_view kPrefix = "batten-";
  return name.size() > kPrefix.size() && name.compare(0, kPrefix.size(), kPrefix) == 0 &&
         name.find_first_not_of("0123456789", kPrefix.size()) == name.npos;
}

std::string NameOfProduct(const Handle(StepBasic_ProductDefinition) & definition) {
  if (definition->Formation().IsNull() || definition->Formation()->OfProduct().IsNull()) return "";
  const Handle(StepBasic_Product) product = definition->Formation()->OfProduct();
  const std::string name = Text(product->Name());
  return IsNumber(name) ? "" : name.empty() ? Text(product->Id()) : name;
}

}  // namespace

StepNames::StepNames(const STEPControl_Reader& reader) {
  const Handle(Transfer_TransientProcess) process =
      reader.WS()->TransferReader()->TransientProcess();
  for (int i = 1; i <= process->NbMapped(); ++i) {
    const Handle(Standard_Transient) entity = process->Mapped(i);
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process->MapItem(i));
    if (shape.IsNull()) continue;
    if (const auto item = Handle(StepRepr_RepresentationItem)::DownCast(entity); !item.IsNull()) {
      const bool single = shape.ShapeType() == TopAbs_FACE || shape.ShapeType() == TopAbs_EDGE;
      Add(shape, NameOfItem(item), single ? Rank::kOwn : Rank::kBody);
      if (single) Add(shape, NameOfGeometry(item), Rank::kGeometry);
    } else if (const auto definition = Handle(StepBasic_ProductDefinition)::DownCast(entity);
               !definition.IsNull()) {
      Add(shape, NameOfProduct(definition), Rank::kProduct);
    }
  }
}

// Of two names of one rank that of fewer shapes is the nearer one.
void StepNames::Add(const TopoDS_Shape& shape, const std::string& name, Rank rank) {
  if (name.empty()) return;
  TopTools_IndexedMapOfShape bearers;
  for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next()) {
    bearers.Add(faces.Current());
  }
  for (TopExp_Explorer edges(shape, TopAbs_EDGE, TopAbs_FACE); edges.More(); edges.Next()) {
    bearers.Add(edges.Current());
  }
  const Named named{name, rank, bearers.Extent()};
  for (int i = 1; i <= bearers.Extent(); ++i) {
    const auto [place, added] = names_.try_emplace(bearers(i).TShape().get(), named);
    Named& known = place->second;
    if (added || std::pair(known.rank, known.shapes) <= std::pair(named.rank, named.shapes)) {
      continue;
    }
    known = named;
  }
}

std::string StepNames::Of(const TopoDS_Shape& shape) const {
  const auto found = names_.find(shape.TShape().get());
  return found == names_.end() ? "" : found->second.name;
}

}  // namespace batten::internal
