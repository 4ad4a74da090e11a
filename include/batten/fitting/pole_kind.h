// SPDX-License-Identifier: MIT
// Edges of a surface that are one point.
#pragma once

#include <numbers>

namespace batten {

// What the edge v = lower or v = upper of a surface is. About a smooth pole the surface has a
// tangent plane; about an apex, as that of a cone, it has not.
enum class PoleKind { kNone, kSmooth, kApex };

struct Poles {
  PoleKind start = PoleKind::kNone, end = PoleKind::kNone;
  double turn = 2 * std::numbers::pi;  // angle about the pole that u sweeps over its domain, > 0

  bool any() const { return start != PoleKind::kNone || end != PoleKind::kNone; }
  bool operator==(const Poles&) const = default;
};

}  // namespace batten
