// SPDX-License-Identifier: MIT
// A fitted surface cut back to where its points are.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/fitting/poles.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct PointTrim {
  NurbsSurface surface;               // without loops where the points fill its domain
  std::vector<std::string> warnings;  // of parts and holes that are not followed
};

// The surface with the outline and the holes of its points as loops (FindOutline), none where the
// points fill the domain, or fall into parts so that one outline would leave out more than 1 %.
// `feet` are the points' parameters on it, `spacing` and `noise` those of the points. Lengths in
// the domain are the mean ones on the surface. O(m log m).
PointTrim TrimToPoints(const NurbsSurface& surface,
                       const Eigen::Matrix2Xd& feet,
                       const Poles& poles,
                       double spacing,
                       double noise,
                       ThreadPool& pool);

// The outer loop of a surface's trims and, from the largest on, the holes that cross neither
// themselves nor what was taken before them; none of it where the outer loop crosses itself.
// `left_out` counts the others. Loops are turned as TurnedLoops turns them. [CheckTrims]
struct CompatibleLoops {
  std::vector<NurbsCurve<2>> loops;
  int left_out = 0;
};
CompatibleLoops LoopsThatGoTogether(const NurbsSurface& trimmed);

// Loops of a domain moved and stretched with it: (u,v) → scale·(u,v) + shift, scale > 0.
std::vector<NurbsCurve<2>> MovedLoops(const std::vector<NurbsCurve<2>>& loops,
                                      const Eigen::Vector2d& scale,
                                      const Eigen::Vector2d& shift);

}  // namespace batten
