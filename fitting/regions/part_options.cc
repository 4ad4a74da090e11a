// SPDX-License-Identifier: MIT
#include "batten/fitting/part_options.h"

#include <cmath>

#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;

void Check(const PartFitOptions& options) {
  const char* const function = "PartFitOptions";
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    Reject(function, "tolerance must be positive");
  }
  if (!(options.most_invented >= 0 && options.most_invented <= 1)) {
    Reject(function, "most_invented must be in [0, 1]");
  }
  if (!(options.least_noise >= 0 && std::isfinite(options.least_noise))) {
    Reject(function, "least_noise must not be negative");
  }
  if (!options.shift.allFinite()) Reject(function, "shift must be finite");
}

}  // namespace batten
