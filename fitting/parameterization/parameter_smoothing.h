// SPDX-License-Identifier: MIT
// Smoothing of a flattened sheet's parameters, accepted if cross-validation improves.
#pragma once

#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/base_score.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// Smooths the parameters of a flattened sheet. Flattening leaves small wrinkles, which a surface
// over the parameters must follow with cells of their size. Surfaces with fewer cells than
// cross-validation asks for, in one direction or both, do not follow them: the foot points on such
// a surface become the parameters if they predict left-out points clearly better, or as well with
// clearly fewer control points. Returns whether any were accepted. Only points under the mask are
// moved. `before` is the score of the present parameters.
struct Settled {
  bool any = false;
  BaseScore::Value value;  // score of the resulting parameters
};
Settled SmoothParameters(Parameterization& base,
                         const PointCloud& points,
                         const PointMask& mask,
                         const BaseScore& score,
                         const BaseScore::Value& before,
                         ThreadPool& pool);
bool SmoothParameters(Parameterization& base,
                      const PointCloud& points,
                      const PointMask& mask,
                      const BaseScore& score,
                      ThreadPool& pool);

}  // namespace batten::internal
