// SPDX-License-Identifier: MIT
#include "fitting/primitives/surface_contact.h"

#include <cmath>

namespace batten::internal {

const char* Name(SurfaceKind kind) {
  switch (kind) {
    case SurfaceKind::kPlane:
      return "plane";
    case SurfaceKind::kSphere:
      return "sphere";
    case SurfaceKind::kCylinder:
      return "cylinder";
    case SurfaceKind::kCone:
      return "cone";
    case SurfaceKind::kTorus:
      return "torus";
  }
  return "";
}

Eigen::Vector3d SurfaceContact::Axis() const {
  return std::sin(slope) * normal + std::cos(slope) * along;
}

Eigen::Vector3d SurfaceContact::Outward() const {
  return std::cos(slope) * normal - std::sin(slope) * along;
}

}  // namespace batten::internal
