// SPDX-License-Identifier: MIT
#include "io/opencascade/brep_export.h"

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <Standard_Failure.hxx>
#include <TopoDS_Compound.hxx>
#include <locale>
#include <sstream>
#include <utility>
#include <vector>

#include "batten/io/read_error.h"
#include "io/opencascade/cad_shapes.h"
#include "io/opencascade/occt_session.h"

namespace batten::internal {
namespace {

TopoDS_Shape Together(const std::vector<ExportPart>& parts) {
  if (parts.size() == 1) return parts[0].shape;
  TopoDS_Compound all;
  const BRep_Builder builder;
  builder.MakeCompound(all);
  for (const ExportPart& part : parts) builder.Add(all, part.shape);
  return all;
}

}  // namespace

std::string ExportBrep(const GeometryFile& file,
                       const std::optional<double>& sew,
                       std::optional<SewingReport>& report) {
  try {
    const OcctSession session;
    const TopoDS_Shape shape = Together(PartsToWrite(file, sew, report));
    std::ostringstream stream;
    stream.imbue(std::locale::classic());
    BRepTools::Write(shape, stream, false, false, TopTools_FormatVersion_VERSION_1);
    if (!stream) throw Standard_Failure("OpenCASCADE does not write the shape");
    return std::move(stream).str();
  } catch (const Standard_Failure& failure) {
    throw WriteError(file.path, std::string("can't become B-rep: ") + failure.GetMessageString());
  }
}

}  // namespace batten::internal
