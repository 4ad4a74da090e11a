// SPDX-License-Identifier: MIT
// Brings a fitted surface back to its points where it leaves them between them.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/surface/surface_measurement.h"

namespace batten::internal {

// Where the surface, inside its trims, overshoots its points (MeasureOvershoot, spacings of
// theirs), its control points move by the least change that brings it back: a spline of the same
// knots that is zero at the points, as the weights of these say, and moves the places that
// overshoot to the heights allowed there, the more firmly in every round. [Lagrangian penalty:
// Nocedal & Wright 2006, §17.1] Least squares leave the points where few of them, or contradicting
// ones, hold a control point: beside cliffs, at holes and borders, around what was set aside. Kept
// only where the greatest overshoot becomes less by a fifth and the rms distance of the points
// grows by a twentieth at most, within a tolerance where all were. Rational surfaces and conditions
// are left alone. `up`: as OvershootInput says. Where progress asks to stop, the best so far is
// judged. Returns whether the surface changed. O(m log m) for each of few rounds.
bool HoldBetweenPoints(SurfaceState& draft,
                       double spacing,
                       const std::optional<Eigen::Vector3d>& up,
                       std::optional<double> tolerance,
                       const Progress& progress,
                       ThreadPool& pool);

}  // namespace batten::internal
