// SPDX-License-Identifier: MIT
// The joint stage of a curve: control points with parameters, weights or knots.
#pragma once

#include "fitting/core/stage_clock.h"
#include "fitting/curve/solve_curve.h"

namespace batten::internal {

// Tries few rational spans where the options free weights, else the joint optimization of what they
// free or, where they leave it open, where it pays: over parameters, or over knots where the
// parameters are given. Keeps of it what stays near the points and their ends. Fills `summary`.
template <int Dim>
void ImproveJointly(CurveTask& task,
                    SolvedCurve& solved,
                    StageClock& clock,
                    OptimizeSummary& summary);

extern template void ImproveJointly<2>(CurveTask&, SolvedCurve&, StageClock&, OptimizeSummary&);
extern template void ImproveJointly<3>(CurveTask&, SolvedCurve&, StageClock&, OptimizeSummary&);

}  // namespace batten::internal
