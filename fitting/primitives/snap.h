// SPDX-License-Identifier: MIT
// F-test of whether a plane, sphere, cylinder, cone or torus fits points as well as a free-form
// surface.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "batten/geometry/thread_pool.h"
#include "fitting/primitives/surface_primitive.h"

namespace batten::internal {

// Residuals and effective freedom of a free-form surface's fit.
struct FreeFormResidual {
  double squares = 0;   // Σ w d², orthogonal distances, weights of mean one
  double unknowns = 0;  // its freedoms along the normal: control points, or with smoothing the
                        // trace of its hat matrix; not three for each control point
  std::optional<double> tolerance = std::nullopt;  // that every point must be within
};

// The first of plane, sphere, cylinder, cone and torus that the points (3 × m, those that the free
// form rests on; weights empty: ones) do not reject against the free form at a level of 1 %: with p
// freedoms and n unknowns, F = ((RSS_p − RSS)/(n − p)) / (RSS/(m − n)) on n − p and m − n freedoms.
// Residuals below `rounding` of the size count as that large. None where all are rejected or miss
// the tolerance, for n ≤ p and for m ≤ n. Coordinates stay the points'. The summary's `why` is a
// sentence for the report with F and its chance. O(m) a kind.
std::optional<DescribedSurface> SnapToPrimitive(const Eigen::Matrix3Xd& points,
                                                const Eigen::VectorXd& weights,
                                                const FreeFormResidual& free_form,
                                                double rounding,
                                                std::uint64_t seed,
                                                ThreadPool& pool);

}  // namespace batten::internal
