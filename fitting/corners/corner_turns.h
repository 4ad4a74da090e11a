// SPDX-License-Identifier: MIT
// Corners of points that noise hardly moves: each point counts. Used by FindCorners only.
#pragma once

#include <vector>

#include "fitting/corners/corner_options.h"

namespace batten::internal {

// As FindCorners, of options that are checked and points that differ from their neighbours.
std::vector<CurveCorner> CornersOfExact(const Eigen::Matrix3Xd& points,
                                        const Eigen::VectorXd& parameters,
                                        const CornerOptions& options);

}  // namespace batten::internal
