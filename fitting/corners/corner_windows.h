// SPDX-License-Identifier: MIT
// Corners of points that scatter: windows of many points count. Used by FindCorners only.
#pragma once

#include <vector>

#include "fitting/corners/corner_options.h"

namespace batten::internal {

// As FindCorners, of options that are checked and a noise above 0.
std::vector<CurveCorner> CornersOfNoisy(const Eigen::Matrix3Xd& points,
                                        const Eigen::VectorXd& parameters,
                                        const CornerOptions& options);

}  // namespace batten::internal
