// SPDX-License-Identifier: MIT
// Cylinders, cones and tori as one family: a circle or line turned about an axis.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// The shape touches `point`. About it the meridian half-plane has the coordinates ξ = (distance
// from the axis less that of `point`, height along `axis`), and the profile is the circle through ξ
// = 0 with the centre ν/curvature, ν = (cos slope, sin slope), or the line there across ν. The axis
// lies at point − outward/axis_curvature. With curvatures in place of radii and lengths from
// `point` in place of those from centres, patches that are nearly flat lose no digits. [Lukács,
// Martin & Marshall 1998]
struct RevolvedCircle {
  Eigen::Vector3d point, outward, axis;  // the last two orthonormal
  double axis_curvature = 0;             // ≥ 0, one over the distance of `point` from the axis
  double slope = 0;
  double curvature = 0;

  // The signed distance of a point in its meridian plane, positive on the side of −ν, from the
  // profile or its mirror image in the axis, whichever is nearer: cones have two nappes, spindles
  // two arcs.
  double Distance(const Eigen::Vector3d& p) const;
};

enum class RevolvedKind { kCylinder, kCone, kTorus };

// The shape of this kind nearest to `start` with the least Σ Distance² over the columns, by
// Gauss–Newton steps over its place, attitude, curvatures and slope, shortened until they lead
// down; freedoms that do not move the shape along itself are left alone. The columns should be of
// about unit size. O(columns) a step.
RevolvedCircle FitRevolved(RevolvedKind kind, RevolvedCircle start, const Eigen::Matrix3Xd& points);

}  // namespace batten::internal
