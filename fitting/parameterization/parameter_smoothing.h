// SPDX-License-Identifier: MIT
// Smoothing of a flattened sheet's parameters, accepted if cross-validation improves.
#pragma once

#include <optional>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/base_score.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// Moves the parameters of some of the points to their feet on a surface.
void MoveToFeet(const NurbsSurface& surface,
                const PointCloud& points,
                const std::vector<Eigen::Index>& some,
                Parameterization& base,
                ThreadPool& pool);

// Smooths the parameters of a flattened sheet. Flattening leaves small wrinkles, which a surface
// over the parameters must follow with cells of their size. Surfaces with fewer cells than
// cross-validation asks for, in one direction or both, do not follow them: the foot points on such
// a surface become the parameters if they predict left-out points clearly better, or as well with
// clearly fewer control points. Returns the score of the resulting parameters; nothing if none were
// accepted. Only points under the mask are moved. `before` is the score of the present parameters.
std::optional<BaseScore::Value> SmoothParameters(Parameterization& base,
                                                 const PointCloud& points,
                                                 const PointMask& mask,
                                                 const BaseScore& score,
                                                 const BaseScore::Value& before,
                                                 ThreadPool& pool);

}  // namespace batten::internal
