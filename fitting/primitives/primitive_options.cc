// SPDX-License-Identifier: MIT
#include "batten/fitting/primitive_options.h"

#include <array>
#include <cmath>

#include "geometry/numeric/enum_name.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;

const char* Name(PrimitiveKind kind) {
  static constexpr std::array kNames{
      "auto", "line", "circle", "plane", "sphere", "cylinder", "cone", "torus"};
  return NameIn<PrimitiveKind::kTorus>(kNames, kind);
}

void Check(const PrimitiveFitOptions& options) {
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    Reject("PrimitiveFitOptions", "tolerance must be positive");
  }
  if (options.loss_scale && !(*options.loss_scale > 0 && std::isfinite(*options.loss_scale))) {
    Reject("PrimitiveFitOptions", "loss_scale must be positive");
  }
  if (!options.shift.allFinite()) Reject("PrimitiveFitOptions", "shift must be finite");
}

}  // namespace batten
