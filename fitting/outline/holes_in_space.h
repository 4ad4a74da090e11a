// SPDX-License-Identifier: MIT
// Which holes of an outline in parameters are holes between the points in space.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// The trim loops without those holes (clockwise loops) that the points cover in space: where
// parameters are stretched, as round a nose laid out by square roots, points as dense as elsewhere
// lie far apart in them. A hole stays if one of its places on the surface is farther than `least`
// from every foot point near it in the parameters. O(m log m), and places · points near for each
// hole.
std::vector<NurbsCurve<2>> HolesInSpace(const NurbsSurface& surface,
                                        const std::vector<NurbsCurve<2>>& loops,
                                        const Eigen::Matrix2Xd& feet,
                                        double least);

}  // namespace batten::internal
