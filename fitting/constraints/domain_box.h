// SPDX-License-Identifier: MIT
// A domain of the surface prescribed by the user.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"
#include "batten/fitting/surface_options.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// Sets the base's rectangle to the box: over a plane, world coordinates along its axes (a box of x
// and y where those are the axes); over a sheet, lengths from the corner of its own rectangle.
// Points outside lose their place. Throws std::invalid_argument where fewer than four points are
// left, or the base is closed.
void TakeDomain(Parameterization& base,
                PointMask& reached,
                const Eigen::Vector3d& origin,
                const DomainBox& box);

}  // namespace batten::internal
