// SPDX-License-Identifier: MIT
#include "batten/io/iges_writer.h"

#include <stdexcept>

#include "batten/io/atomic_file.h"
#include "batten/io/length_unit.h"
#include "io/exchange/opencascade_functions.h"

namespace batten {
using namespace internal;

void WriteIges(const std::vector<Geometry>& geometry,
               const std::string& path,
               const std::string& unit) {
  WriteIges(GeometryFile{path, geometry}, {.unit = unit});
}

void WriteIges(const GeometryFile& file, const GeometryWriteOptions& options) {
  if (file.geometry.empty()) throw std::invalid_argument("WriteIges: there is no geometry");
  const LengthUnit& unit = LengthUnitOf(options.unit);
  AtomicFile target(file.path);
  target.Write(OpenCascade().export_iges(file, unit));
  target.Commit();
}

}  // namespace batten
