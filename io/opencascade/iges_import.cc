// SPDX-License-Identifier: MIT
#include "io/opencascade/iges_import.h"

#include <sys/mman.h>
#include <unistd.h>

#include <IGESControl_Controller.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Check.hxx>
#include <Interface_Static.hxx>
#include <Standard_Failure.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <map>
#include <new>
#include <utility>
#include <vector>

#include "batten/io/read_error.h"
#include "io/exchange/geometry_names.h"
#include "io/opencascade/occt_session.h"
#include "io/opencascade/occt_shapes.h"

namespace batten::internal {
namespace {

// Of an entity: its name property, or else its label.
std::string NameOf(const Handle(IGESData_IGESEntity) & entity) {
  const Handle(TCollection_HAsciiString) name =
      entity->HasName() ? entity->NameValue() : entity->ShortLabel();
  return name.IsNull() ? "" : CleanName(name->ToCString());
}

// Of shapes by themselves; of a body its faces bear no other.
std::map<const void*, std::string> NamesIn(const IGESControl_Reader& reader) {
  std::map<const void*, std::string> names;
  const Handle(Transfer_TransientProcess) process =
      reader.WS()->TransferReader()->TransientProcess();
  for (int i = 1; i <= process->NbMapped(); ++i) {
    const auto entity = Handle(IGESData_IGESEntity)::DownCast(process->Mapped(i));
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process->MapItem(i));
    if (!entity.IsNull() && !shape.IsNull()) names[shape.TShape().get()] = NameOf(entity);
  }
  return names;
}

// Whether an entity was not read as it should be: the transfer would follow pointers to nothing.
bool Damaged(const IGESData_IGESModel& model) {
  for (int i = 1; i <= model.NbEntities(); ++i) {
    if (model.IsErrorEntity(i) || model.Check(i, true)->HasFailed()) return true;
  }
  return false;
}

// Surfaces, curves and faces of which no shape was made.
std::vector<std::string> Lost(const IGESControl_Reader& reader) {
  constexpr int kFirstShape = 100, kLastShape = 199, kPolyline = 106, kPointSets = 3, kPoint = 116,
                kDirection = 123, kMatrix = 124, kBounded = 143, kTrimmed = 144, kAssembly = 184,
                kSolid = 186, kInstance = 408, kFace = 510;
  const Handle(Transfer_TransientProcess) process =
      reader.WS()->TransferReader()->TransientProcess();
  const Handle(IGESData_IGESModel) model = reader.IGESModel();
  std::vector<std::string> lost;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(IGESData_IGESEntity) entity = model->Entity(i);
    const int type = entity->TypeNumber();
    const bool points = type == kPoint || (type == kPolyline && entity->FormNumber() <= kPointSets);
    const bool alone = entity->SubordinateStatus() == 0 && entity->UseFlag() == 0 && !points &&
                       type != kDirection && type != kMatrix && type != kAssembly &&
                       type != kSolid &&
                       ((type >= kFirstShape && type <= kLastShape) || type == kInstance);
    if (!alone && type != kFace && type != kTrimmed && type != kBounded) continue;
    const Handle(Transfer_Binder) binder = process->Find(entity);
    if (!binder.IsNull() && !TransferBRep::ShapeResult(binder).IsNull()) continue;
    lost.push_back("entity D" + std::to_string(2 * i - 1) + " (type " + std::to_string(type) +
                   "): OpenCASCADE makes no shape of it");
  }
  return lost;
}

// Text as a file, which is all that OpenCASCADE reads IGES from.
class TextFile {
 public:
  explicit TextFile(const std::string& text) : file_(memfd_create("batten", MFD_CLOEXEC)) {
    size_t written = 0;
    while (file_ >= 0 && written < text.size()) {
      const ssize_t some = write(file_, text.data() + written, text.size() - written);
      if (some <= 0) break;
      written += static_cast<size_t>(some);
    }
    if (written < text.size()) throw std::bad_alloc();
  }
  ~TextFile() {
    if (file_ >= 0) close(file_);
  }
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

GeometryContents Translate(const std::string& text) {
  GeometryContents contents;
  IGESControl_Controller::Init();
  IGESControl_Reader reader;
  if (reader.ReadFile(TextFile(text).path().c_str()) != IFSelect_RetDone) return contents;
  if (Damaged(*reader.IGESModel())) return contents;
  // Numbers stay in the file's unit.
  IGESData_GlobalSection& global = reader.IGESModel()->ChangeGlobalSection();
  global.SetCascadeUnit(global.UnitValue());
  reader.TransferRoots();
  const std::map<const void*, std::string> names = NamesIn(reader);
  ShapeCollector collector(contents, [&names](const TopoDS_Shape& shape) {
    const auto found = names.find(shape.TShape().get());
    return found == names.end() ? "" : found->second;
  });
  for (int i = 1; i <= reader.NbShapes(); ++i) collector.Add(reader.Shape(i));
  collector.Finish();
  collector.TellLost(Lost(reader));
  contents.flattened = WhatIsFlattened(contents, 0);
  return contents;
}

}  // namespace

GeometryContents ImportIges(const std::string& text, const std::string& name) {
  try {
    const OcctSession session;
    return Translate(text);
  } catch (const Standard_Failure& failure) {
    throw ReadError(name, std::string("is damaged: ") + failure.GetMessageString());
  }
}

}  // namespace batten::internal
