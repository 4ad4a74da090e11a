// SPDX-License-Identifier: MIT
// Points of a surface into memory of the caller's own.
#pragma once

#include <span>

#include "batten/geometry/surface_evaluator.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

// The points at (us[k], vs[k]), x, y, z one after the other from points[3k] on: bit by bit what
// SurfaceEvaluator::Points gives, written once. Throws std::invalid_argument where the sizes of us
// and vs differ, points has not three numbers for each, or a parameter is NaN.
void PointsInto(const SurfaceEvaluator& surface,
                std::span<const double> us,
                std::span<const double> vs,
                std::span<double> points,
                ThreadPool& pool);

}  // namespace batten
