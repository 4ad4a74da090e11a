// SPDX-License-Identifier: MIT
// Trimming of a fitted surface to the outline of its points.
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
  std::vector<std::string> warnings;  // about parts, and loops that are left out
  int parts = 1;                      // connected parts of the points, each a region of the surface
  std::vector<Eigen::Index> outside;  // points whose feet lie outside the loops
};

// Trims the surface by the outlines of the parts of its points and their holes (FindOutline); no
// loops where the points fill the domain. `feet` are the foot point parameters of the points,
// `spacing` and `noise` those of the points. Lengths in the domain are mean lengths on the surface.
// O(m log m).
PointTrim TrimToPoints(const NurbsSurface& surface,
                       const Eigen::Matrix2Xd& feet,
                       const Poles& poles,
                       double spacing,
                       double noise,
                       ThreadPool& pool);

// The compatible trim loops of a surface, in their order: from the largest on, so that holes follow
// what they are in and islands their holes, those that cross neither themselves nor loops taken
// before them, nor lie where those forbid. `left_out` counts the others. [CheckTrims]
struct CompatibleLoops {
  std::vector<NurbsCurve<2>> loops;
  int left_out = 0;
};
CompatibleLoops LoopsThatGoTogether(const NurbsSurface& trimmed);

// Maps loops by (u,v) → scale·(u,v) + shift, scale > 0.
std::vector<NurbsCurve<2>> MovedLoops(const std::vector<NurbsCurve<2>>& loops,
                                      const Eigen::Vector2d& scale,
                                      const Eigen::Vector2d& shift);

}  // namespace batten
