// SPDX-License-Identifier: MIT
// How far a surface leaves its points between them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct OvershootInput {
  const NurbsSurface& surface;
  const Eigen::Matrix3Xd& points;  // that the surface was fitted to, at least one
  const Eigen::Matrix2Xd& feet;    // their parameters on the surface
  double spacing = 0;              // of the points
  // The direction of heights, where the surface is a height field; else normals of the surface
  // nearby are.
  std::optional<Eigen::Vector3d> up = std::nullopt;
};

// The direction of heights of a fit over a plane; none of others.
std::optional<Eigen::Vector3d> DirectionOfHeights(const FitReport& report);

// Measures the surface against its points, inside its trims, at places at most two spacings apart,
// or more where that would be some 100 000. From here on spacings are those of the points there. A
// place within three spacings of a point is with its
// points. Elsewhere the gap g is the distance along the surface to the nearest foot point, and the
// surface may have any height that points have within 2g + 3 spacings along it: what exceeds that
// is overshoot; of more than some 10 000 such places every so many are asked. The area without
// points is that within three spacings of such places: the union of balls that hold no point. O(m
// log m).
OvershootSummary MeasureOvershoot(const OvershootInput& input, ThreadPool& pool);

// A place where the surface overshoots.
struct Excursion {
  Eigen::Vector2d uv;
  Eigen::Vector3d back;  // the way to the nearest height allowed there
  double spacing;        // of the points there
};

// The places measured that overshoot by more than so many spacings. O(m log m).
std::vector<Excursion> FindExcursions(const OvershootInput& input, double least, ThreadPool& pool);

}  // namespace batten::internal
