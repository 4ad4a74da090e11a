// SPDX-License-Identifier: MIT
// Corner detection in noisy points, by windows of many points. Used by FindCorners only.
#pragma once

#include <vector>

#include "fitting/corners/corner_options.h"

namespace batten::internal {

// Where noise is far above the steps, a side of the narrowest windows is so many times the noise.
inline constexpr double kBroadWidths = 60;

// FindCorners for noisy points. Options must be checked, and their noise above 0.
std::vector<CurveCorner> CornersOfNoisy(const Eigen::Matrix3Xd& points,
                                        const Eigen::VectorXd& parameters,
                                        const CornerOptions& options);

}  // namespace batten::internal
