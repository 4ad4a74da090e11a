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

void WriteSolid(const SolidModel& solid,
                const std::string& path,
                const GeometryWriteOptions& options) {
  if (batten::FormatOf(path, options.format) != FileFormat::kStep) {
    throw UsageError(path + ": a solid is written as .step in this version");
  }
  const char* unit = LengthUnitOf(options.unit).step;
  const char* schema = OcctSchema(options.step_schema);
  AtomicFile target(path);
  target.Write(WithShortestReals(OpenCascade().export_solid(solid, path, unit, schema)));
  target.Commit();
}

}  // namespace batten
