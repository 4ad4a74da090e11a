// SPDX-License-Identifier: MIT
// What may be done to a fitted surface before it is measured: an exact shape in its place,
// symmetry, the user's domain and side, and the trim back to the points.
#pragma once

#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/surface/surface_fitter.h"
#include "fitting/surface/surface_preparation.h"

namespace batten::internal {

// An exact shape in place of the free form where it explains the points as well; the report says
// which, or that there is none. `cloud` is as the user gave it.
void SnapToShape(FittedState& fitted,
                 const PointCloud& cloud,
                 const SurfaceFitOptions& options,
                 ThreadPool& pool);

// The surface next to this one that mirrors itself; knots without a mirror image get theirs.
void MakeNetSymmetric(NurbsSurface& surface, const CloudSymmetry& symmetry);

// Cuts the surface back to the points that count, where they leave part of the domain open; where
// that is not asked for, a warning says how much is open.
void TrimToUsed(FittedState& fitted,
                const PreparedCloud& prepared,
                const SurfaceFitOptions& options,
                ThreadPool& pool);

// The box's own numbers for parameters.
void TakeParametersOf(const DomainBox& box, SurfaceState& draft);

// Turns the surface round where most of the points' normals look to its other side. Throws
// std::invalid_argument where they have none.
void TakeSideOfNormals(SurfaceState& draft);

}  // namespace batten::internal
