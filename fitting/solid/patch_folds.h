// SPDX-License-Identifier: MIT
// Folds of a limit surface, and steps that make none.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "geometry/subdivision/limit_surface.h"

namespace batten::internal {

// Of some patches, ascending, those that turn over, or nearly, from one sample to the next.
std::vector<int> FoldedPatches(const LimitStencils& stencils,
                               const std::vector<int>& patches,
                               const Eigen::Matrix3Xd& control_points,
                               ThreadPool& pool);

// Shortens the step of the control points where some patches would fold, until none does that did
// not before; the patches folded after it, none where that does not help.
std::optional<std::vector<int>> Unfold(const LimitStencils& stencils,
                                       const std::vector<int>& patches,
                                       const Eigen::Matrix3Xd& control_points,
                                       const std::vector<int>& before,
                                       Eigen::Matrix3Xd& step,
                                       ThreadPool& pool);

}  // namespace batten::internal
