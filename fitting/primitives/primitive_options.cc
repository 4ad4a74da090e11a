// SPDX-License-Identifier: MIT
#include "batten/fitting/primitive_options.h"

#include <cmath>

#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;

const char* Name(PrimitiveKind kind) {
  switch (kind) {
    case PrimitiveKind::kAuto:
      return "auto";
    case PrimitiveKind::kLine:
      return "line";
    case PrimitiveKind::kCircle:
      return "circle";
    case PrimitiveKind::kPlane:
      return "plane";
    case PrimitiveKind::kSphere:
      return "sphere";
    case PrimitiveKind::kCylinder:
      return "cylinder";
    case PrimitiveKind::kCone:
      return "cone";
    case PrimitiveKind::kTorus:
      return "torus";
  }
  return "";
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
