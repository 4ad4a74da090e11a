// SPDX-License-Identifier: MIT
// Distances of points from a solid of spline faces over a limit surface.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/solid_model.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/foot_points/nearest_surface.h"
#include "fitting/solid/surface_feet.h"
#include "geometry/subdivision/spline_faces.h"

namespace batten::internal {

// The patches of these faces, marked; empty where there are none.
std::vector<char> PatchesOf(const std::vector<int>& faces, int patches);

// The blocks with faces that are caps, marked; empty where there are none.
std::vector<char> CapBlocks(const std::vector<int>& caps,
                            const std::vector<BlockPlace>& places,
                            std::size_t blocks);

// From the faces that SplineSolid made of the blocks, which `places` tells, of a mesh refined so
// often; the blocks of what is
// no ground are marked as left out, and faces are numbered without these.
NearestSurfaces MeasureSolid(const SolidModel& solid,
                             const std::vector<BlockPlace>& places,
                             int refinements,
                             const FootGround& ground,
                             const std::vector<char>& left_out,
                             const Eigen::Matrix3Xd& points,
                             ThreadPool& pool);

}  // namespace batten::internal
