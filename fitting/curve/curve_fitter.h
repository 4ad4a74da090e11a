// SPDX-License-Identifier: MIT
// The stages of one curve's fit, from ordered points to the curve and its report.
#pragma once

#include "batten/fitting/curve_options.h"
#include "batten/fitting/ordered_points.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/stage_clock.h"

namespace batten::internal {

// Fits the points of one component of a cloud. `sequence_outliers` marks the points that belong to
// no component. Throws as FitCurve does.
template <int Dim>
CurveFit<Dim> FitOrdered(const PointCloud& cloud,
                         const OrderedPoints& ordered,
                         const PointMask& sequence_outliers,
                         const CurveFitOptions& options,
                         ThreadPool& pool,
                         StageClock& clock);

extern template CurveFit<2> FitOrdered<2>(const PointCloud&,
                                          const OrderedPoints&,
                                          const PointMask&,
                                          const CurveFitOptions&,
                                          ThreadPool&,
                                          StageClock&);
extern template CurveFit<3> FitOrdered<3>(const PointCloud&,
                                          const OrderedPoints&,
                                          const PointMask&,
                                          const CurveFitOptions&,
                                          ThreadPool&,
                                          StageClock&);

}  // namespace batten::internal
