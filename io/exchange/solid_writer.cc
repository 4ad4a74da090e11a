// SPDX-License-Identifier: MIT
#include "batten/io/solid_writer.h"

#include "batten/io/atomic_file.h"
#include "batten/io/file_format.h"
#include "batten/io/length_unit.h"
#include "batten/io/read_error.h"
#include "io/exchange/opencascade_functions.h"
#include "io/exchange/step_schema.h"
#include "io/exchange/step_text.h"

namespace batten {
using namespace internal;

namespace {

void RefuseOtherFormats(const std::string& path, const std::string& format) {
  if (batten::FormatOf(path, format) != FileFormat::kStep) {
    throw UsageError(path + ": a solid is written as .step in this version");
  }
}

void WriteText(const std::string& path, const std::string& text) {
  AtomicFile target(path);
  target.Write(WithShortestReals(text));
  target.Commit();
}

}  // namespace

void WriteSolid(const SolidModel& solid,
                const std::string& path,
                const GeometryWriteOptions& options) {
  RefuseOtherFormats(path, options.format);
  const char* unit = LengthUnitOf(options.unit).step;
  const char* schema = OcctSchema(options.step_schema);
  WriteText(path, OpenCascade().export_solid(solid, path, unit, schema));
}

SolidCensus WriteSolid(const TrimmedSolid& solid,
                       const std::string& path,
                       const GeometryWriteOptions& options) {
  RefuseOtherFormats(path, options.format);
  const char* unit = LengthUnitOf(options.unit).step;
  const char* schema = OcctSchema(options.step_schema);
  SolidCensus census;
  WriteText(path, OpenCascade().export_trimmed_solid(solid, path, unit, schema, census));
  return census;
}

SolidCensus CensusOf(const TrimmedSolid& solid) {
  const GeometryWriteOptions options;
  SolidCensus census;
  OpenCascade().export_trimmed_solid(
      solid, "the solid", LengthUnitOf(options.unit).step, OcctSchema(options.step_schema), census);
  return census;
}

}  // namespace batten
