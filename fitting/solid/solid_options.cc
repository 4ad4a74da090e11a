// SPDX-License-Identifier: MIT
#include "batten/fitting/solid_options.h"

#include <cmath>
#include <string>

#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;

void Check(const SolidFitOptions& options) {
  const std::string function = "SolidFitOptions";
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    Reject(function, "tolerance must be positive");
  }
  if (options.smoothing && !(*options.smoothing >= 0 && std::isfinite(*options.smoothing))) {
    Reject(function, "smoothing must not be negative");
  }
  if (options.max_iterations < 1) Reject(function, "max_iterations must be at least 1");
  if (!options.shift.allFinite()) Reject(function, "shift must be finite");
}

}  // namespace batten
