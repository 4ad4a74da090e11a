// SPDX-License-Identifier: MIT
#include "fitting/primitives/surface_contact.h"

#include <cmath>

#include "batten/fitting/primitive_options.h"

namespace batten::internal {

// Primitives have these kinds in the same order from the plane on.
const char* Name(SurfaceKind kind) {
  static_assert(static_cast<int>(PrimitiveKind::kTorus) - static_cast<int>(PrimitiveKind::kPlane) ==
                static_cast<int>(SurfaceKind::kTorus));
  return Name(
      static_cast<PrimitiveKind>(static_cast<int>(PrimitiveKind::kPlane) + static_cast<int>(kind)));
}

Eigen::Vector3d SurfaceContact::Axis() const {
  return std::sin(slope) * normal + std::cos(slope) * along;
}

Eigen::Vector3d SurfaceContact::Outward() const {
  return std::cos(slope) * normal - std::sin(slope) * along;
}

double SurfaceContact::PipeRadius() const {
  return 1 / std::abs(kind == SurfaceKind::kCylinder ? axis_curvature : curvature);
}

double SurfaceContact::NaturalSide() const {
  if (kind == SurfaceKind::kPlane) return 1;
  if (kind == SurfaceKind::kSphere || kind == SurfaceKind::kTorus) return curvature;
  return kind == SurfaceKind::kCone ? axis_curvature * std::cos(slope) : axis_curvature;
}

}  // namespace batten::internal
