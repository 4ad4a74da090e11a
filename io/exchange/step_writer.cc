// SPDX-License-Identifier: MIT
#include "batten/io/step_writer.h"

#include <stdexcept>

#include "batten/io/atomic_file.h"
#include "batten/io/length_unit.h"
#include "batten/io/read_error.h"
#include "io/exchange/opencascade_functions.h"
#include "io/exchange/sewing_request.h"
#include "io/exchange/step_schema.h"
#include "io/exchange/step_text.h"

namespace batten {
using namespace internal;

void WriteStep(const std::vector<Geometry>& geometry,
               const std::string& path,
               const std::string& unit) {
  WriteStep(GeometryFile{path, geometry}, {.unit = unit});
}

std::optional<SewingReport> WriteStep(const GeometryFile& file,
                                      const GeometryWriteOptions& options) {
  if (file.geometry.empty()) throw std::invalid_argument("WriteStep: there is no geometry");
  const char* unit = LengthUnitOf(options.unit).step;
  const char* schema = OcctSchema(options.step_schema);
  CheckSewing(file, options);
  std::optional<SewingReport> report;
  AtomicFile target(file.path);
  target.Write(
      WithShortestReals(OpenCascade().export_step(file, unit, schema, options.sew, report)));
  target.Commit();
  return report;
}

}  // namespace batten
