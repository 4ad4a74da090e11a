// SPDX-License-Identifier: MIT
// The result of a curve fit: final coordinates, residuals and termination.
#pragma once

#include "fitting/curve/solve_curve.h"

namespace batten::internal {

// Moves the solved curve to its final coordinates, measures the distance of every point of the
// cloud from the result, rounding of far coordinates included, and sets the termination by what was
// measured. `report` holds the history of the stages. Of the estimator it sets `used`.
template <int Dim>
CurveFit<Dim> MeasuredCurve(const CurveTask& task,
                            const SolvedCurve& solved,
                            const PointCloud& cloud,
                            const PointMask& sequence_outliers,
                            FitReport report);

extern template CurveFit<2> MeasuredCurve<2>(
    const CurveTask&, const SolvedCurve&, const PointCloud&, const PointMask&, FitReport);
extern template CurveFit<3> MeasuredCurve<3>(
    const CurveTask&, const SolvedCurve&, const PointCloud&, const PointMask&, FitReport);

}  // namespace batten::internal
