// SPDX-License-Identifier: MIT
// Selects the kind of surface by an information criterion and tests residuals for structure. Used
// by FitPrimitive only.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "fitting/primitives/shape_fitter.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct SurfaceChoice {
  ShapeFit fit;
  std::string why;
};

// The first of plane, sphere, cylinder, cone and torus that no later kind fits significantly
// better. With m points, D the fall of Σ w min(d, c)² in units of the later one's variance divided
// by the inflation of its estimate, k the difference of freedoms (at least one) and f = m − the
// later's freedoms, a later kind is significantly better where f log(1 + D/f) > 2 k log m (1 +
// 2/f). Kinds of which there are not three points for each freedom do not count, nor do those that
// fit nothing. None where no kind is left. [Schwarz 1978]
std::optional<SurfaceChoice> ChooseSurface(ShapeFitter& fitter, double rounding, ThreadPool& pool);

// The correlation of distances at neighbouring points, 0 to 1, estimated from some thousands of the
// points that count, each with its nearest neighbour. It is 0 for fewer than 30 points and for
// distances below `rounding`. O(m log m) for at most some thousands.
double SharedVariance(const ShapeFit& fit,
                      const Eigen::Matrix3Xd& points,
                      double rounding,
                      std::uint64_t seed);

}  // namespace batten::internal
