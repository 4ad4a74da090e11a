// SPDX-License-Identifier: MIT
// Distances of points from a solid of spline faces over a limit surface.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/solid_model.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/foot_points/nearest_surface.h"
#include "geometry/subdivision/limit_surface.h"
#include "geometry/subdivision/spline_faces.h"

namespace batten::internal {

// The blocks with faces that are caps, marked; empty where there are none.
std::vector<char> CapBlocks(const std::vector<int>& caps,
                            const std::vector<BlockPlace>& places,
                            std::size_t blocks);

// From the faces that SplineSolid made of the blocks, which `places` tells; not of those left out,
// if any are marked, and faces are numbered without these.
NearestSurfaces MeasureSolid(const SolidModel& solid,
                             const std::vector<char>& left_out,
                             const std::vector<BlockPlace>& places,
                             const LimitStencils& stencils,
                             const Eigen::Matrix3Xd& control_points,
                             const Eigen::Matrix3Xd& points,
                             ThreadPool& pool);

}  // namespace batten::internal
