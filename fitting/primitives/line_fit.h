// SPDX-License-Identifier: MIT
// Orthogonal-distance fit of a line to points.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "fitting/primitives/shape_data.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct FittedLine {
  static constexpr int kSample = 2;  // points that determine a line

  Eigen::Vector3d point, direction;  // the direction has length one

  double Distance(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d from = p - point;
    return (from - from.dot(direction) * direction).norm();
  }

  // The line through two points; none where they coincide.
  static std::optional<FittedLine> Through(const Eigen::Matrix3Xd& sample);

  // The line of least Σ w d², exact, from the principal axes of the points. Its point is the
  // centroid.
  static FittedLine Start(const ShapeData& data, ThreadPool& pool);

  // The local minimum of Σ w ρ(d) below this line: iterative reweighting, each step of which lowers
  // the sum (ρ'(d)/d does not rise), until the line no longer moves. O(m) a step.
  FittedLine Minimised(const ShapeData& data,
                       const ShapeLoss& loss,
                       int most_steps,
                       ThreadPool& pool) const;
};

}  // namespace batten::internal
