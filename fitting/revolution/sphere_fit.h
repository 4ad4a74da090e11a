// SPDX-License-Identifier: MIT
// The sphere nearest to nodes, and the axis its parameters should have.
#pragma once

#include <Eigen/Core>

#include "fitting/revolution/revolution_axis.h"
#include "fitting/revolution/revolution_samples.h"

namespace batten::internal {

struct FittedSphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;  // 0: the nodes lie in a plane
  double misfit = 0;  // distance of the nodes, root mean square, over the radius
};

// By orthogonal distances, robust. O(n).
FittedSphere FitSphere(const RevolutionSamples& round);

// The axis about which the smallest rectangle of angle and height holds the nodes: by Archimedes,
// the one that leaves the least of the rectangle empty. Of nearly equal ones a coordinate axis, z
// before y before x. Poles in the midst of data count a little against an axis.
AxisFrame AxisOfSphere(const RevolutionSamples& round, const FittedSphere& sphere);

}  // namespace batten::internal
