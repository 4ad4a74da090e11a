// SPDX-License-Identifier: MIT
// Input points, weights and loss of a single-shape fit (line, circle, surface).
#pragma once

#include <Eigen/Core>

#include "batten/fitting/robust_loss.h"

namespace batten::internal {

// Points about the origin and of about unit size.
struct ShapeData {
  Eigen::Matrix3Xd points;
  Eigen::VectorXd weights;  // positive, one a point
  bool plane = false;       // the points have z = 0, and so has the shape
};

// Points that judge candidates for a shape.
inline constexpr Eigen::Index kShapeJudges = 500;

struct ShapeLoss {
  Loss loss = Loss::kNone;
  double scale = 1;  // > 0
};

}  // namespace batten::internal
