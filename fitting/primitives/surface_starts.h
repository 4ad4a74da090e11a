// SPDX-License-Identifier: MIT
// Start values for the orthogonal-distance fit of a plane, sphere, cylinder, cone or torus.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/primitives/fitted_surface.h"
#include "fitting/primitives/oriented_points.h"
#include "fitting/primitives/shape_data.h"

namespace batten::internal {

// Data that the starts of all kinds share.
struct StartData {
  ShapeData sample;                      // some thousands of the points
  ShapeData judges;                      // some hundreds of them
  std::vector<OrientedPoints> oriented;  // at a few widths
  Eigen::Vector3d centroid, middle;      // `middle` is a point near the centroid
  Eigen::Matrix3d inertia_axes;          // columns, the longest first
};

// The start data of a cloud, with at most `most` points in the sample. O(m + most·log most).
StartData MakeStartData(const ShapeData& data,
                        Eigen::Index most,
                        std::uint64_t seed,
                        ThreadPool& pool);

// Centroid, middle and axes, from the sample.
void TakeMoments(StartData& start);

// Candidates from closed formulas: from the points' moments, the normals' (the direction all are
// perpendicular to, the line all meet, the point all tangent planes contain) and quadrics about the
// middle. [Taubin 1991; Pottmann & Randrup 1998; Lukács, Martin & Marshall 1998]
std::vector<FittedSurface> MomentStarts(SurfaceKind kind, const StartData& data);

// The two shapes of least median distance among shapes through minimal random samples of oriented
// points; half of the points may be outliers. Empty for tori, and without normals. [Rousseeuw 1984;
// Schnabel, Wahl & Klein 2007]
std::vector<FittedSurface> ConsensusStarts(SurfaceKind kind,
                                           const StartData& data,
                                           std::uint64_t seed);

// Starts for cones and tori made from a fitted cylinder: opened a little to either side, and bent
// as its points are.
std::vector<FittedSurface> StartsFromCylinder(SurfaceKind kind,
                                              const FittedSurface& cylinder,
                                              const StartData& data);

}  // namespace batten::internal
