// SPDX-License-Identifier: MIT
// A surface's domain as the user prescribes it.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"
#include "batten/fitting/surface_options.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// Makes the base's rectangle the box: over a plane, world coordinates along its axes (so that where
// those are x and y, it is a box of x and y); over a sheet, lengths from the corner of its own
// rectangle. Points outside lose their place. Throws std::invalid_argument where fewer than four
// are left, or the base closes.
void TakeDomain(Parameterization& base,
                PointMask& reached,
                const Eigen::Vector3d& origin,
                const DomainBox& box);

}  // namespace batten::internal
