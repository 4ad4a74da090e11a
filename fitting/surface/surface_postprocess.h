// SPDX-License-Identifier: MIT
// Post-processing of a fitted surface before measurement: replacement by an exact primitive,
// symmetry, the user's domain and orientation, trimming to the points.
#pragma once

#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/surface/fit_over_base.h"
#include "fitting/surface/surface_preparation.h"

namespace batten::internal {

// Replaces the free-form surface by an exact primitive that explains the points as well; the report
// names it, or says that there is none. `cloud` is as the user gave it.
void SnapToShape(FittedState& fitted,
                 const PointCloud& cloud,
                 const SurfaceFitOptions& options,
                 ThreadPool& pool);

// Makes the control net symmetric under the reflection; knots without a mirror image get theirs.
void MakeNetSymmetric(NurbsSurface& surface, const CloudSymmetry& symmetry);

// Trims the surface to its inliers where they leave part of the domain empty; where trimming is
// off, a warning gives the empty share.
void TrimToUsed(FittedState& fitted,
                const PreparedCloud& prepared,
                const SurfaceFitOptions& options,
                ThreadPool& pool);

// Maps the surface's domain and the parameters to the numbers of the box.
void TakeParametersOf(const DomainBox& box, SurfaceState& draft);

// Reverses the surface's orientation where most of the points' normals point to its other side.
// Throws std::invalid_argument where the points have no normals.
void TakeSideOfNormals(SurfaceState& draft);

}  // namespace batten::internal
