// SPDX-License-Identifier: MIT
// Standard deviations of the parameters of a fitted line or circle. Used by fit_primitive only.
#pragma once

#include <vector>

#include "fitting/primitives/circle_fit.h"
#include "batten/fitting/fit_report.h"
#include "fitting/primitives/line_fit.h"
#include "fitting/primitives/shape_data.h"

namespace batten::internal {

// The covariance σ² (Σ w J Jᵀ)⁻¹ over the points used, with a loss times the factor of an
// M-estimate; σ² is their sum of squares over the degrees of freedom left. The radius and centre of
// short arcs have no normal errors: three of their standard deviations reach as far as they do at
// three of the curvature's; infinite where the curvature changes its sign on the way. Distances
// below `rounding` count as that large. Lengths in `unit`s of the data. [Huber 1981, §7.6] O(m).
PrimitiveAccuracy AccuracyOf(const FittedLine& line,
                             const ShapeData& data,
                             const std::vector<Eigen::Index>& used,
                             const ShapeLoss& loss,
                             double rounding,
                             double unit);

PrimitiveAccuracy AccuracyOf(const FittedCircle& circle,
                             const ShapeData& data,
                             const std::vector<Eigen::Index>& used,
                             const ShapeLoss& loss,
                             double rounding,
                             double unit);

}  // namespace batten::internal
