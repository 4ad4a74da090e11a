// SPDX-License-Identifier: MIT
// Parameters of a sheet laid out flat, made smoother where that pays.
#pragma once

#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/base_score.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// Laying out leaves small wrinkles, which a surface over the parameters must follow with cells of
// their size. Surfaces of fewer cells than cross-validation asks for, in one direction or both, do
// not follow them: wherever left-out points are predicted clearly better from the feet of the
// points on such a surface, or as well with clearly fewer control points, those become the
// parameters. Returns whether any did. Only points under the mask are moved.
// `before` is the score of the parameters there are.
struct Settled {
  bool any = false;
  BaseScore::Value value;  // over the parameters there are now
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
