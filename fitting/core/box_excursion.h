// SPDX-License-Identifier: MIT
// How far a curve or surface leaves the box of its points.
#pragma once

#include <Eigen/Geometry>

#include "batten/fitting/fit_report.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// Where the shape, sampled 32 times a span (surfaces: 8 in each direction), lies outside the box of
// its points by more than half its diagonal, which no residual shows: enters the farthest such
// place as the report's overshoot, `at` from the `origin`. Trims are not looked at. O(samples);
// O(control points) where these are inside.
template <int Dim>
void EnterExcursion(const NurbsCurve<Dim>& curve,
                    const Eigen::AlignedBox<double, Dim>& box,
                    const Eigen::Vector3d& origin,
                    FitReport& report);
void EnterExcursion(const NurbsSurface& surface,
                    const Eigen::AlignedBox3d& box,
                    const Eigen::Vector3d& origin,
                    FitReport& report);

// The report's warning of an excursion, if there is one. After JudgeEnd.
void WarnOfExcursion(FitReport& report);

}  // namespace batten::internal
