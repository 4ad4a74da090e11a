// SPDX-License-Identifier: MIT
// A cloud with the samples and statistics that every round base is fitted to.
#pragma once

#include <Eigen/Core>

#include "fitting/revolution/revolution_samples.h"

namespace batten::internal {

struct RevolutionEstimate;

// Input shared by the fits of several round bases to one cloud.
struct RoundCloud {
  const Eigen::Matrix3Xd& points;
  const RevolutionSamples& round;
  double spacing, noise, margin;
  const RevolutionEstimate* shape = nullptr;  // about no preferred axis; spheres need none
};

}  // namespace batten::internal
