// SPDX-License-Identifier: MIT
// Where two shapes touch along a whole curve, as a fillet does with what it joins.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "fitting/primitives/fitted_surface.h"

namespace batten::internal {

// What makes the curve: a direction that both slide along (planes, cylinders), an axis that both
// turn about, or a ball that fills both (pipes: cylinders, tori and spheres of one radius).
enum class ContactKind { kStraight, kRound, kPipe };

inline constexpr ContactKind kContactKinds[] = {
    ContactKind::kStraight, ContactKind::kRound, ContactKind::kPipe};

// A contact of one kind near a place.
struct SmoothContact {
  ContactKind kind = ContactKind::kStraight;
  Eigen::Vector3d near = Eigen::Vector3d::Zero();
};

// What is zero where two shapes have the contact, lengths and sines, two to five; none where shapes
// of their kinds can't have it. [Plane sections through the direction or axis: two circles touch
// whose centres are as far apart as their signed radii differ.]
std::optional<Eigen::VectorXd> ContactGap(const SmoothContact& contact,
                                          const FittedSurface& a,
                                          const FittedSurface& b);

// The plane, cone or cylinder of the normals along the curve, which it cuts from both shapes.
FittedSurface NormalsAlong(const SmoothContact& contact,
                           const FittedSurface& a,
                           const FittedSurface& b);

}  // namespace batten::internal
