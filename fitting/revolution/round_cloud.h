// SPDX-License-Identifier: MIT
// A cloud with what every round base over it is found from.
#pragma once

#include <Eigen/Core>

#include "fitting/revolution/revolution_samples.h"

namespace batten::internal {

struct RevolutionEstimate;

// What only the points and their scale determine, for several of these over one cloud.
struct RoundCloud {
  const Eigen::Matrix3Xd& points;
  const RevolutionSamples& round;
  double spacing, noise, margin;
  const RevolutionEstimate* shape = nullptr;  // found about no preferred axis, if it is known
};

}  // namespace batten::internal
