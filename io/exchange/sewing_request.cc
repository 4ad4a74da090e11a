// SPDX-License-Identifier: MIT
#include "io/exchange/sewing_request.h"

#include <cmath>
#include <stdexcept>

namespace batten::internal {

void CheckSewing(const GeometryFile& file, const GeometryWriteOptions& options) {
  if (options.sew && !(std::isfinite(*options.sew) && *options.sew >= 0)) {
    throw std::invalid_argument("GeometryWriteOptions: sew must be a distance, 0 or above");
  }
  std::vector<bool> taken(file.geometry.size());
  for (const GeometryBody& body : file.bodies) {
    for (const size_t k : body.surfaces) {
      if (k >= taken.size() || !std::holds_alternative<NurbsSurface>(file.geometry[k])) {
        throw std::invalid_argument("GeometryFile: a body names what is no surface of the file");
      }
      if (taken[k]) throw std::invalid_argument("GeometryFile: two bodies name one surface");
      taken[k] = true;
    }
  }
}

}  // namespace batten::internal
