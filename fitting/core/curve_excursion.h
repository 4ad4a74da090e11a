// SPDX-License-Identifier: MIT
// How far a curve leaves the box of its points.
#pragma once

#include <Eigen/Geometry>

#include "batten/fitting/fit_report.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// Where the curve, sampled 32 times a span, lies outside the box of its points by more than half
// its diagonal, which no residual shows: enters the farthest such place as the report's overshoot,
// `at` from the `origin`. O(samples).
template <int Dim>
void EnterExcursion(const NurbsCurve<Dim>& curve,
                    const Eigen::AlignedBox<double, Dim>& box,
                    const Eigen::Vector3d& origin,
                    FitReport& report);

// The report's warning of an excursion, if there is one. After JudgeEnd.
void WarnOfExcursion(FitReport& report);

}  // namespace batten::internal
