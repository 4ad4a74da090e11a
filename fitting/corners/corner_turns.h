// SPDX-License-Identifier: MIT
// Corner detection in exact points, by turns at single points. Used by FindCorners only.
#pragma once

#include <vector>

#include "fitting/corners/corner_options.h"

namespace batten::internal {

// FindCorners for exact points. Options must be checked, and points differ from their neighbours.
std::vector<CurveCorner> CornersOfExact(const Eigen::Matrix3Xd& points,
                                        const Eigen::VectorXd& parameters,
                                        const CornerOptions& options);

}  // namespace batten::internal
