// SPDX-License-Identifier: MIT
// The part of a plane, sphere, cylinder, cone or torus that its points cover, as an exact NURBS
// patch.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"
#include "batten/geometry/exact_shape.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/primitives/fitted_surface.h"

namespace batten::internal {

// The part that holds the foot points of all inliers: of a plane the smallest rectangle; heights
// and angles about the axis of cylinders and cones, the tip included where points lie beyond it;
// two ranges of angles of a torus; of a sphere the smallest of the patches between parallels and
// meridians about some axes. Angles are all round where no gap is above 60°, a sphere is whole
// where no empty cap is wider. Where there are outliers, isolated points on the shape do not count
// either: some outliers happen to lie near its continuation. Throws std::invalid_argument, with a
// sentence for the user, where a length or angle is zero. O(m) but for the corners of the hull.
ExactSurface PatchOf(const FittedSurface& shape,
                     const Eigen::Matrix3Xd& points,
                     const PointMask& outliers,
                     ThreadPool& pool);

// Parameters (u, v) of the points' foot points on the NURBS of the patch; for feet beyond its
// edges, those of the nearest place in either parameter.
Eigen::Matrix2Xd FootPointsOn(const ExactSurface& patch,
                              const Eigen::Matrix3Xd& points,
                              ThreadPool& pool);

// The patch mapped by x → scale · x + shift.
ExactSurface Placed(const ExactSurface& patch, double scale, const Eigen::Vector3d& shift);

}  // namespace batten::internal
