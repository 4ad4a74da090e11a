// SPDX-License-Identifier: MIT
// What the fits of single shapes (lines, circles) work on. Used by them only.
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

struct ShapeLoss {
  Loss loss = Loss::kNone;
  double scale = 1;  // > 0
};

}  // namespace batten::internal
