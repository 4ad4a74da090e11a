// SPDX-License-Identifier: MIT
// Parameters of a mapped sheet, settled on a surface of few control points.
#pragma once

#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/base_score.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// Replaces the parameters of a sheet, good to a share of its width, by the foot points on a surface
// that is near the points with few control points. The net begins with as many cells as the sheet
// bends, and grows in the direction that pays most while its generalised cross-validation score
// falls; at every size a few joint steps over control points and parameters bring it nearer to the
// points, whose parameters it carries along. So the parameters follow the sheet's shape, not the
// map's: a net that is too coarse for their wrinkles cannot keep them. `sample` marks the points
// that shape the surface, some thousands; those under the mask are moved. The rectangle becomes
// that of the points' new parameters, widened by `margin`. Returns whether the surface could be
// settled; if not, or where a net of more control points than the rival's (null: none) is behind
// it, the base is left unchanged. O(points of the sample) a step, some dozens. [alternation after
// Hoschek 1988; tangent distances: Wang, Pottmann & Liu 2006]
bool SettleParameters(Parameterization& base,
                      const PointCloud& points,
                      const PointMask& mask,
                      const PointMask& sample,
                      double margin,
                      const BaseScore::Value* rival,
                      ThreadPool& pool);

}  // namespace batten::internal
