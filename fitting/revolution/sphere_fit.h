// SPDX-License-Identifier: MIT
// Sphere fit to nodes, and the axis of its parameterization.
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

// Fits a sphere by orthogonal least squares, then with Cauchy's loss at the scale of what they
// leave. O(n).
FittedSphere FitSphere(const RevolutionSamples& round, ThreadPool& pool);

// Finds the axis about which the smallest rectangle of angle and height holds the nodes: by
// Archimedes, the one that leaves the least of the rectangle empty. Among nearly equal ones a
// coordinate axis is preferred, z before y before x. Poles amid data count a little against an
// axis.
AxisFrame AxisOfSphere(const RevolutionSamples& round, const FittedSphere& sphere);

}  // namespace batten::internal
