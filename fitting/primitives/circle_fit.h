// SPDX-License-Identifier: MIT
// Orthogonal-distance fit of a circle to points in the plane or in space.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "batten/geometry/thread_pool.h"
#include "fitting/primitives/shape_data.h"

namespace batten::internal {

// A circle by one of its points and its curvature, so that flat arcs lose no digits and a line is
// the circle of curvature zero. About `point`, ξ runs along `outward`, η along `tangent` and ζ
// along the axis; the centre is at ξ = −1/curvature.
struct FittedCircle {
  static constexpr int kSample = 3;  // points that determine a circle

  Eigen::Vector3d point, outward, tangent;  // the last two orthonormal
  double curvature = 0;

  Eigen::Vector3d Axis() const { return outward.cross(tangent); }
  Eigen::Vector3d Center() const { return point - outward / curvature; }

  // The distance in space of p from the circle itself, not from its plane or cylinder.
  double Distance(const Eigen::Vector3d& p) const;

  // The angle about the centre from `point` to the foot point of p, in (−π, π].
  double AngleOf(const Eigen::Vector3d& p) const;
  Eigen::Vector3d At(double angle) const;

  // The same circle with a positive curvature.
  FittedCircle Outward() const;

  // The circle through three points; none where they are on one line.
  static std::optional<FittedCircle> Through(const Eigen::Matrix3Xd& sample);

  // The better of two algebraic circles (Taubin's), in the plane of inertia and in the plane that
  // the points bend in seen along their longest axis: the first serves full circles, the second
  // short arcs. [Taubin 1991; Chernov 2010, §5.10]
  static FittedCircle Start(const ShapeData& data, ThreadPool& pool);

  // The local minimum of Σ w ρ(d) below this circle, over its point, attitude and curvature at
  // once (ShapeDescent). Never worse than this circle. O(m) a step.
  FittedCircle Minimised(const ShapeData& data,
                         const ShapeLoss& loss,
                         int most_steps,
                         ThreadPool& pool) const;
};

}  // namespace batten::internal
