// SPDX-License-Identifier: MIT
#include "batten/io/brep_writer.h"

#include <stdexcept>

#include "batten/io/atomic_file.h"
#include "io/exchange/opencascade_functions.h"
#include "io/exchange/sewing_request.h"

namespace batten {
using namespace internal;

std::optional<SewingReport> WriteBrep(const GeometryFile& file,
                                      const GeometryWriteOptions& options) {
  if (file.geometry.empty()) throw std::invalid_argument("WriteBrep: there is no geometry");
  CheckSewing(file, options);
  std::optional<SewingReport> report;
  AtomicFile target(file.path);
  target.Write(OpenCascade().export_brep(file, options.sew, report));
  target.Commit();
  return report;
}

}  // namespace batten
